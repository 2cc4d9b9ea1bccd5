// SPDX-License-Identifier: Apache-2.0
#include "label_measures.h"

#include <algorithm>
#include <cmath>

namespace trocar::anatomy {
namespace {

constexpr double kLargestVoxelMm = 20.0;

/// Calls visit(i, j, k) for every voxel of the label.
template <typename Visit>
void ForEachVoxel(const images::LabelVolume& labels, int label, const Visit& visit) {
  std::size_t at = 0;
  for (int k = 0; k < labels.size[2]; ++k) {
    for (int j = 0; j < labels.size[1]; ++j) {
      for (int i = 0; i < labels.size[0]; ++i) {
        if (labels.labels[at++] == label) visit(i, j, k);
      }
    }
  }
}

/// The side of the body to which a direction points most.
std::string SideOf(const math::Vec3& direction) {
  constexpr const char* kSides[3][2] = {{"right", "left"}, {"caudal", "cranial"}, {"posterior", "anterior"}};
  const std::array<double, 3> parts = {direction.x, direction.y, direction.z};
  std::size_t most = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (std::fabs(parts[axis]) > std::fabs(parts[most])) most = axis;
  }
  return kSides[most][parts[most] > 0 ? 1 : 0];
}

}  // namespace

base::Result<VoxelFrame> MakeVoxelFrame(const images::LabelVolume& labels, bool is_mirrored) {
  VoxelFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& d = labels.direction[axis];
    const math::Vec3 world = {is_mirrored ? -d[0] : d[0], d[2], -d[1]};
    const double step = Norm(world);
    if (!(step > 0.01 && step <= kLargestVoxelMm)) {
      return base::Error{base::ErrorCode::kLabelsMismatch, "voxels measure " + std::to_string(step) +
                                                               " mm along axis " + std::to_string(axis + 1) +
                                                               "; they must measure 0.01 to 20 mm"};
    }
    frame.step_mm[axis] = step;
    frame.axes[axis] = world / step;
  }
  if (std::fabs(Dot(Cross(frame.axes[0], frame.axes[1]), frame.axes[2])) < 0.99)
    return base::Error{base::ErrorCode::kLabelsMismatch, "its axes are not at right angles; resample it"};
  return frame;
}

LabelMeasures MeasureLabel(const images::LabelVolume& labels, int label, const VoxelFrame& frame) {
  LabelMeasures measures;
  measures.min = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, measures.max = -1.0 * measures.min;
  std::size_t count = 0;
  math::Vec3 sum;
  std::array<std::array<std::size_t, 2>, 3> on_border{};  // [axis][first or last]
  ForEachVoxel(labels, label, [&](int i, int j, int k) {
    const math::Vec3 place = frame.PlaceOf(i, j, k);
    ++count;
    sum += place;
    measures.min = {std::min(measures.min.x, place.x), std::min(measures.min.y, place.y),
                    std::min(measures.min.z, place.z)};
    measures.max = {std::max(measures.max.x, place.x), std::max(measures.max.y, place.y),
                    std::max(measures.max.z, place.z)};
    const std::array<int, 3> index = {i, j, k};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (index[axis] == 0) ++on_border[axis][0];
      if (index[axis] == labels.size[axis] - 1) ++on_border[axis][1];
    }
  });
  if (count == 0) return {};
  measures.volume_ml = static_cast<double>(count) * frame.VoxelMm3() / 1000.0;
  measures.centre = sum / static_cast<double>(count);

  double square = 0, cube = 0;
  ForEachVoxel(labels, label, [&](int i, int j, int k) {
    const double left = frame.PlaceOf(i, j, k).x - measures.centre.x;
    square += left * left;
    cube += left * left * left;
  });
  const double deviation = std::sqrt(square / static_cast<double>(count));
  if (deviation > 0)
    measures.skewness_left = cube / static_cast<double>(count) / (deviation * deviation * deviation);

  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::size_t end : {0u, 1u}) {
      if (on_border[axis][end] == 0) continue;
      const double area = static_cast<double>(on_border[axis][end]) * frame.VoxelMm3() / frame.step_mm[axis];
      measures.cuts.push_back({SideOf(end == 0 ? -1.0 * frame.axes[axis] : frame.axes[axis]), area});
    }
  }
  return measures;
}

}  // namespace trocar::anatomy
