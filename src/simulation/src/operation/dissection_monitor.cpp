// SPDX-License-Identifier: Apache-2.0
#include "operation/dissection_monitor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::simulation {
namespace {

/// A part of the bed is off when no more than this share of its strands is left [-].
constexpr double kLeftInBin = 0.1;
/// What is seen may lie this near behind a surface [m]: sight ends at the skin of a duct, not at its axis.
constexpr double kSkin = 0.004;
/// What lies this near to the infundibulum turns with the neck [m].
constexpr double kNeckRadius = 0.015;

}  // namespace

DissectionMonitor::DissectionMonitor(const anatomy::Patient& patient, std::span<const SurfaceInfo> surfaces,
                                     std::span<const StrandInfo> strands, std::span<const Vec3> rest) {
  const int gallbladder = patient.FindOrgan("gallbladder");
  const anatomy::Landmark *fundus = patient.FindLandmark("fundus"),
                          *neck = patient.FindLandmark("infundibulum");
  using Kind = StrandInfo::Kind;
  std::vector<std::vector<std::uint32_t>> at(rest.size());
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    const Kind kind = strands[i].kind;
    if (kind == Kind::kTriangle || kind == Kind::kPeritoneum) triangle_.push_back(i);
    if (kind == Kind::kBed && fundus != nullptr && neck != nullptr) {
      const Vec3 axis = fundus->position - neck->position;
      const double along =
          math::Dot(rest[strands[i].a] - neck->position, axis) / std::max(1e-12, math::SquaredNorm(axis));
      bed_.push_back(i);
      bed_bin_.push_back(static_cast<std::uint8_t>(
          std::clamp(along * static_cast<double>(kBins), 0.0, static_cast<double>(kBins - 1))));
    }
    if (kind == Kind::kTriangle || kind == Kind::kPeritoneum || kind == Kind::kAdhesion) {
      at[strands[i].a].push_back(i);
      at[strands[i].b].push_back(i);
    }
  }
  fibre_starts_.push_back(0);
  for (const auto& list : at) {
    fibres_.insert(fibres_.end(), list.begin(), list.end());
    fibre_starts_.push_back(static_cast<std::uint32_t>(fibres_.size()));
  }
  if (gallbladder < 0) return;
  const SurfaceInfo& organ = surfaces[static_cast<std::size_t>(gallbladder)];
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = surfaces[patient.organs.size() + t];
    const anatomy::Tube& tube = patient.tubes[t];
    Entering entering{t, {}, {}};
    for (std::uint32_t k = 0; k < surface.node_count; ++k) entering.nodes.push_back(surface.first_node + k);
    if (tube.to == "gallbladder") std::reverse(entering.nodes.begin(), entering.nodes.end());
    if (tube.name == "cystic_duct") {
      duct_nodes_ = entering.nodes;
      std::reverse(duct_nodes_.begin(), duct_nodes_.end());
    }
    if (tube.name == "common_hepatic_duct") plate_nodes_ = entering.nodes;
    // one that only grazes the bed, Luschka's duct, is divided with the bed
    if (tube.from != "gallbladder" && tube.to != "gallbladder") continue;
    for (std::uint32_t i = 0; i < strands.size(); ++i) {
      const bool is_end = strands[i].kind == Kind::kEnd && strands[i].a == entering.nodes.front();
      if (is_end && strands[i].b >= organ.first_node && strands[i].b < organ.first_node + organ.node_count)
        entering.end_strands.push_back(i);
    }
    entering_.push_back(std::move(entering));
  }
  for (std::uint32_t k = 0; neck != nullptr && k < organ.node_count; ++k) {
    const Vec3& p = rest[organ.first_node + k];
    if (math::Distance(p, neck->position) > kNeckRadius) continue;
    neck_nodes_.push_back(organ.first_node + k);
    neck_rest_.push_back(p);
  }
  if (!duct_nodes_.empty()) duct_rest_ = {rest[duct_nodes_.front()], rest[duct_nodes_.back()]};
  if (!plate_nodes_.empty() && !duct_nodes_.empty() &&
      math::Distance(rest[plate_nodes_.back()], rest[duct_nodes_.front()]) <
          math::Distance(rest[plate_nodes_.front()], rest[duct_nodes_.front()]))
    std::reverse(plate_nodes_.begin(), plate_nodes_.end());
  facts_.skeletonised.reserve(entering_.size());
}

void DissectionMonitor::Update(const tissue::TissueState& tissue, const VesselWork& vessels,
                               std::span<const surgery::OrganSurface> organs, const Camera& camera) noexcept {
  const auto is_intact = [&](std::uint32_t strand) { return tissue.strand_is_intact[strand] != 0; };
  const auto intact = static_cast<double>(std::count_if(triangle_.begin(), triangle_.end(), is_intact));
  facts_.cleared_share = triangle_.empty() ? 1.0 : 1.0 - intact / static_cast<double>(triangle_.size());

  std::array<int, kBins> all{}, left{};
  for (std::size_t i = 0; i < bed_.size(); ++i) {
    ++all[bed_bin_[i]];
    left[bed_bin_[i]] += is_intact(bed_[i]) ? 1 : 0;
  }
  std::size_t first = 0, last = 0, off = 0;
  while (first < kBins && all[first] == 0) ++first;
  for (std::size_t bin = first; bin < kBins; ++bin) last = all[bin] > 0 ? bin + 1 : last;
  for (off = first; off < last && left[off] <= kLeftInBin * all[off];) ++off;
  facts_.detached_share =
      last > first ? static_cast<double>(off - first) / static_cast<double>(last - first) : 1.0;

  facts_.structures_entering = 0;
  facts_.skeletonised.clear();
  for (const Entering& tube : entering_) {
    const bool holds = std::any_of(tube.end_strands.begin(), tube.end_strands.end(), is_intact);
    if (!holds || vessels.CountCuts(tube.tube) > 0) continue;
    ++facts_.structures_entering;
    // fat that lies on the gallbladder's own wall at the very end is none of the duct's
    double length = 0;
    for (std::size_t k = 1; k < tube.nodes.size(); ++k) {
      const std::uint32_t node = tube.nodes[k];
      const bool is_covered = std::any_of(fibres_.begin() + fibre_starts_[node],
                                          fibres_.begin() + fibre_starts_[node + 1], is_intact);
      if (is_covered) break;
      length += math::Distance(tissue.position[tube.nodes[k - 1]], tissue.position[node]);
    }
    facts_.skeletonised.push_back(length);
  }
  Look(tissue, organs, camera);
}

void DissectionMonitor::Look(const tissue::TissueState& tissue, std::span<const surgery::OrganSurface> organs,
                             const Camera& camera) noexcept {
  facts_.is_triangle_in_view = false;
  facts_.view_azimuth = std::nan("");
  if (duct_nodes_.empty() || plate_nodes_.empty()) return;
  const auto at = [&](const std::vector<std::uint32_t>& nodes, double share) {
    return tissue.position[nodes[static_cast<std::size_t>(share * static_cast<double>(nodes.size() - 1))]];
  };
  const std::array<Vec3, 3> points = {at(duct_nodes_, 0.3), at(duct_nodes_, 0.7),
                                      0.5 * (at(duct_nodes_, 0.5) + at(plate_nodes_, 0.5))};
  const Vec3 eye = camera.X_world_camera.translation;
  facts_.is_triangle_in_view = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    if (!IsInView(camera.X_world_camera, camera.field_of_view, p)) return false;
    const Vec3 end = p + kSkin * math::Normalized(eye - p);
    return std::none_of(organs.begin(), organs.end(), [&](const surgery::OrganSurface& organ) {
      const auto nearest =
          organ.tree.FindNearestToSegment(organ.Nodes(tissue.position), {eye, end}, {.max_distance = 1e-6});
      return nearest.Found();
    });
  });
  facts_.view_azimuth = CalcAzimuth(tissue, eye);
}

/// The eye's direction about the cystic duct, in the frame of the gallbladder's neck, which surgeon and camera turn
/// against each other. Zero as it was seen first.
double DissectionMonitor::CalcAzimuth(const tissue::TissueState& tissue, const Vec3& eye) noexcept {
  tissue::MotionMoments moments;
  for (std::size_t i = 0; i < neck_nodes_.size(); ++i)
    moments.AddPoint(1.0, neck_rest_[i], tissue.position[neck_nodes_[i]]);
  const Pose X_world_neck = tissue::FitRigidMotion(moments, neck_turn_);
  neck_turn_ = X_world_neck.rotation;
  const Vec3 along = math::Normalized(duct_rest_[1] - duct_rest_[0]);
  const Vec3 front = math::Normalized(Vec3{0, 0, 1} - along * along.z, {1, 0, 0});
  const Vec3 to_eye = math::Rotate(math::Inverse(neck_turn_), eye - X_world_neck * duct_rest_[1]);
  const double azimuth = std::atan2(math::Dot(to_eye, math::Cross(along, front)), math::Dot(to_eye, front));
  if (!has_looked_) first_azimuth_ = azimuth;
  has_looked_ = true;
  return std::remainder(azimuth - first_azimuth_, 2.0 * M_PI);
}

void DissectionMonitor::VisitState(core::StateArchive& archive) {
  archive.Field("neck_turn", neck_turn_);
  archive.Field("first_azimuth", first_azimuth_);
  archive.Field("has_looked", has_looked_);
  archive.Field("facts", facts_);
}

}  // namespace trocar::simulation
