// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/dissection_monitor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"
#include "trocar/math/state_fields.h"

namespace trocar::cholecystectomy {

using math::Pose;
using math::Vec3;
namespace {

/// A part of the bed is off when no more than this share of its strands is left [-].
constexpr double kLeftInBin = 0.1;

}  // namespace

DissectionMonitor::DissectionMonitor(DissectedAnatomy anatomy, std::span<const Vec3> rest)
    : anatomy_(std::move(anatomy)) {
  TROCAR_ASSERT(anatomy_.exposable.size() == anatomy_.entering.size());
  for (const DissectedAnatomy::BedFibre& fibre : anatomy_.bed)
    bed_bins_.push_back(base::TruncateTo<std::uint8_t>(
        std::clamp(fibre.along * static_cast<double>(kBins), 0.0, static_cast<double>(kBins - 1))));
  for (const std::uint32_t node : anatomy_.neck) neck_rest_.push_back(rest[node]);
  if (!anatomy_.cystic_duct.empty())
    duct_rest_ = {rest[anatomy_.cystic_duct.front()], rest[anatomy_.cystic_duct.back()]};
  facts_.skeletonised.reserve(anatomy_.entering.size());
  facts_.exposable.reserve(anatomy_.entering.size());
}

void DissectionMonitor::Update(const tissue::TissueState& tissue, const surgery::Vessels& vessels,
                               std::span<const surgery::OrganSurface> organs,
                               const instrument::Camera& camera) noexcept {
  const auto is_intact = [&](std::uint32_t strand) { return tissue.strand_is_intact[strand] != 0; };
  facts_.cleared_share = anatomy_.triangle.CalcClearedShare(tissue.strand_is_intact);

  std::array<int, kBins> all{}, left{};
  for (std::size_t i = 0; i < bed_bins_.size(); ++i) {
    ++all[bed_bins_[i]];
    left[bed_bins_[i]] += is_intact(anatomy_.bed[i].strand) ? 1 : 0;
  }
  std::size_t first = 0, last = 0, off = 0;
  while (first < kBins && all[first] == 0) ++first;
  for (std::size_t bin = first; bin < kBins; ++bin) last = all[bin] > 0 ? bin + 1 : last;
  for (off = first; off < last && left[off] <= kLeftInBin * all[off];) ++off;
  facts_.detached_share =
      last > first ? static_cast<double>(off - first) / static_cast<double>(last - first) : 1.0;

  facts_.structures_entering = 0;
  facts_.skeletonised.clear();
  facts_.exposable.clear();
  for (std::size_t i = 0; i < anatomy_.entering.size(); ++i) {
    const surgery::EnteringTube& tube = anatomy_.entering[i];
    const bool holds = std::any_of(tube.end_strands.begin(), tube.end_strands.end(), is_intact);
    if (!holds || vessels.CountCuts(tube.tube) > 0) continue;
    ++facts_.structures_entering;
    // fat that lies on the gallbladder's own wall at the very end is none of the duct's
    double length = 0;
    for (std::size_t k = 1; k < tube.nodes.size(); ++k) {
      const std::uint32_t node = tube.nodes[k];
      const auto fibres = anatomy_.fibres.Row(node);
      const bool is_covered = std::any_of(fibres.begin(), fibres.end(), is_intact);
      if (is_covered) break;
      length += math::Distance(tissue.position[tube.nodes[k - 1]], tissue.position[node]);
    }
    facts_.skeletonised.push_back(length);
    facts_.exposable.push_back(anatomy_.exposable[i]);
  }
  anatomy_.sight.Update(tissue.strand_is_intact,
                        [&](std::uint32_t tube) { return vessels.CountCuts(tube) > 0; });
  Look(tissue, organs, camera);
}

void DissectionMonitor::Look(const tissue::TissueState& tissue, std::span<const surgery::OrganSurface> organs,
                             const instrument::Camera& camera) noexcept {
  facts_.is_triangle_in_view = false;
  facts_.view_azimuth = std::nan("");
  TriangleSight& sight = anatomy_.sight;
  if (!sight.HasTriangle()) return;
  const std::span<const Vec3> points = sight.FindPoints(tissue.position);
  const Vec3 eye = camera.X_world_camera.translation;
  facts_.is_triangle_in_view = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    if (!instrument::IsInView(camera.X_world_camera, camera.field_of_view, p)) return false;
    const bool is_behind_organ =
        std::any_of(organs.begin(), organs.end(), [&](const surgery::OrganSurface& organ) {
          return organ.tree
              .FindNearestToSegment(organ.Nodes(tissue.position), TriangleSight::LineTo(p, eye),
                                    {.max_distance = 1e-6})
              .Found();
        });
    return !is_behind_organ && !sight.DoesFatHide(tissue.position, p, eye);
  });
  facts_.view_azimuth = CalcAzimuth(tissue, eye);
}

/// The eye's direction about the cystic duct, in the frame of the gallbladder's neck, which surgeon and camera turn
/// against each other. Zero as it was seen first.
double DissectionMonitor::CalcAzimuth(const tissue::TissueState& tissue, const Vec3& eye) noexcept {
  tissue::MotionMoments moments;
  for (std::size_t i = 0; i < neck_rest_.size(); ++i)
    moments.AddPoint(1.0, neck_rest_[i], tissue.position[anatomy_.neck[i]]);
  const Pose X_world_neck = tissue::FitRigidMotion(moments, neck_turn_);
  neck_turn_ = X_world_neck.rotation;
  const Vec3 along = math::Normalized(duct_rest_[1] - duct_rest_[0]);
  const Vec3 front = math::Normalized(Vec3{0, 0, 1} - along * along.z, {1, 0, 0});
  const Vec3 to_eye = math::Rotate(math::Inverse(neck_turn_), eye - X_world_neck * duct_rest_[1]);
  const double azimuth = math::Atan2(math::Dot(to_eye, math::Cross(along, front)), math::Dot(to_eye, front));
  if (!has_looked_) first_azimuth_ = azimuth;
  has_looked_ = true;
  return std::remainder(azimuth - first_azimuth_, 2.0 * M_PI);
}

void DissectionMonitor::VisitState(base::StateArchive& archive) {
  archive.Field("neck_turn", neck_turn_);
  archive.Field("first_azimuth", first_azimuth_);
  archive.Field("has_looked", has_looked_);
  archive.Field("facts", facts_);
}

}  // namespace trocar::cholecystectomy
