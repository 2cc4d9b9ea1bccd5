// SPDX-License-Identifier: Apache-2.0
#include "body_shape.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::anatomy {
namespace {

constexpr double kSampleMm = 3.0;
constexpr std::size_t kLeastSamples = 60;  // of a spine or vessel that says where the middle is

struct Mean {
  double sum = 0;
  std::size_t count = 0;

  void Add(double value) { sum += value, ++count; }
  double Value() const { return sum / static_cast<double>(count); }
};

}  // namespace

void FrontMap::Add(const math::Vec3& p) {
  const std::pair cell{base::FloorTo<int>(p.x / kCell), base::FloorTo<int>(p.y / kCell)};
  const auto [at, is_new] = heights_.try_emplace(cell, p.z);
  if (!is_new) at->second = std::max(at->second, p.z);
}

std::optional<double> FrontMap::FindHeight(double x, double y, double radius) const {
  std::optional<double> height;
  const int reach = base::CeilTo<int>(radius / kCell);
  const int column = base::FloorTo<int>(x / kCell), row = base::FloorTo<int>(y / kCell);
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      if (math::Hypot(i, j) * kCell > radius) continue;
      const auto found = heights_.find({column + i, row + j});
      if (found != heights_.end()) height = std::max(height.value_or(found->second), found->second);
    }
  }
  return height;
}

BodyShape MeasureBody(const images::LabelVolume& volume, const NeighbourLabels& labels,
                      const VoxelFrame& frame, const math::Vec3& shift) {
  BodyShape body;
  std::array<int, 3> step{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    step[axis] = std::max(1, base::RoundTo<int>(kSampleMm / frame.step_mm[axis]));
  Mean spine, aorta, cava, third, fourth;
  for (int k = 0; k < volume.size[2]; k += step[2]) {
    for (int j = 0; j < volume.size[1]; j += step[1]) {
      const std::size_t row = (static_cast<std::size_t>(k) * volume.size[1] + j) * volume.size[0];
      for (int i = 0; i < volume.size[0]; i += step[0]) {
        const std::int32_t label = volume.labels[row + static_cast<std::size_t>(i)];
        if (label == 0) continue;
        const math::Vec3 p = 0.001 * frame.PlaceOf(i, j, k) + shift;
        if (label == labels.body) {
          body.skin.Add(p);
          continue;
        }
        body.organs.Add(p);
        if (label == labels.third_lumbar) third.Add(p.y);
        if (label == labels.fourth_lumbar) fourth.Add(p.y);
        const auto role = labels.roles.find(label);
        if (role == labels.roles.end()) continue;
        if (role->second == roles::NeighbourRole::kSpine) spine.Add(p.x);
        if (role->second == roles::NeighbourRole::kAorta) aorta.Add(p.x);
        if (role->second == roles::NeighbourRole::kVenaCava) cava.Add(p.x);
      }
    }
  }
  if (spine.count >= kLeastSamples) {
    body.midline = spine.Value();
  } else if (aorta.count >= kLeastSamples && cava.count >= kLeastSamples) {
    body.midline = 0.5 * (aorta.Value() + cava.Value());
    body.is_midline_of_spine = false;
  }
  if (third.count > 0 && fourth.count > 0) body.navel = 0.5 * (third.Value() + fourth.Value());
  return body;
}

}  // namespace trocar::anatomy
