// SPDX-License-Identifier: Apache-2.0
// What the surgeon sees: which fibres are left, how ducts and arteries lie, what is clipped, where to hold.
#include <algorithm>
#include <cmath>
#include <limits>

#include "cholecystectomy_surgeon.h"
#include "trocar/math/elementary.h"
#include "trocar/patient/patient.h"
#include "trocar/tissue/rest_frame.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;
using simulation::Snapshot;
using surgery::ClipSnapshot;

namespace {

using Kind = scene::StrandInfo::Kind;

constexpr double kBare = 0.0103;          // of each of them, or all that is exposable, for the view [m]
constexpr double kSkeletonised = 0.0125;  // likewise of each tube that enters, from the gallbladder on [m]
/// A hold lies this far from where the work is, clear of the liver.
constexpr double kHoldAway = 0.020, kLeastAway = 0.010, kMostAway = 0.060, kHoldClear = 0.008;  // [m]
constexpr double kJawsBeyond = 0.005;                    // of a grasper's tip beyond the hold [m]
constexpr double kFacing = 0.006;                        // worth of wall that faces the port [m]
constexpr double kShaftClear = 0.006, kShaftWay = 0.10;  // of the shaft, and the length that is looked at [m]
constexpr double kSameHold = 0.004;                      // [m]
constexpr double kInfundibulum = 0.012;                  // of the gallbladder, from the neck on [m]
constexpr double kOffBed = 0.1;  // of the bed's fibres: with fewer the gallbladder hangs free [-]
constexpr double kLeastFlap = 0.012,
                 kMostFlap = 0.035;  // of a hold from where it peels off, along what is free [m]

}  // namespace

/// Where an eye is about the cystic duct, in the frame of the gallbladder's neck, which turns under the hand; 0 as at the
/// start.
double CholecystectomySurgeon::CalcAzimuth(std::span<const Vec3> positions, const Vec3& eye) const {
  tissue::MotionMoments moments;
  for (const std::uint32_t node : known_.neck_nodes)
    moments.AddPoint(1.0, known_.rest[node], positions[node]);
  const Pose X_world_neck = tissue::FitRigidMotion(moments, math::Quaternion{});
  const auto& duct = known_.tube_nodes[FindTube(roles::TubeRole::kCysticDuct)];
  const Vec3 along = math::Normalized(known_.rest[duct.front()] - known_.rest[duct.back()]);
  const Vec3 front = math::Normalized(Vec3{0, 0, 1} - along * along.z, {1, 0, 0});
  const Vec3 to_eye =
      math::Rotate(math::Inverse(X_world_neck.rotation), eye - X_world_neck * known_.rest[duct.front()]);
  const double azimuth = math::Atan2(math::Dot(to_eye, math::Cross(along, front)), math::Dot(to_eye, front));
  return std::remainder(azimuth - picture_.first_azimuth, 2.0 * M_PI);
}

/// How far a segment is from where a duct or artery that is whole enters the gallbladder [m].
double CholecystectomySurgeon::EndDistance(const Snapshot& seen, const collision::Segment& segment) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : known_.end_strands) {
    const collision::Segment end{seen.positions[known_.strands[i].a], seen.positions[known_.strands[i].b]};
    const double distance = collision::FindNearestSegmentSegment(end, segment).squared_distance;
    if (distance >= least) continue;
    const bool is_whole = std::any_of(known_.entering.begin(), known_.entering.end(), [&](std::size_t tube) {
      return known_.tube_nodes[tube].front() == known_.strands[i].a && !IsDivided(seen, tube);
    });
    if (is_whole) least = distance;
  }
  return std::sqrt(least);
}

/// Fibres that cover the ends of the tubes that enter the gallbladder.
std::vector<std::uint32_t> CholecystectomySurgeon::CoveringStrands(const Snapshot& seen) const {
  std::vector<std::uint8_t> is_end(known_.rest.size(), 0);
  for (const std::size_t tube : known_.entering) {
    double arc = 0, length = 0;
    const auto& nodes = known_.tube_nodes[tube];
    const double wanted = std::min(kBare, known_.exposable[tube]);
    // a covered node ends what is bare at the node before it; a tube that is pushed together shows less than at rest
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const bool is_short = length < wanted;
      const bool is_exposable = arc < known_.exposable[tube];
      arc += math::Distance(known_.rest[nodes[k - 1]], known_.rest[nodes[k]]);
      length += math::Distance(seen.positions[nodes[k - 1]], seen.positions[nodes[k]]);
      if (is_short || (is_exposable && arc < kSkeletonised)) is_end[nodes[k]] = 1;
    }
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < known_.strands.size(); ++i) {
    const Kind kind = known_.strands[i].kind;
    if (kind != Kind::kTriangle && kind != Kind::kPeritoneum && kind != Kind::kAdhesion) continue;
    if (is_end[known_.strands[i].a] || is_end[known_.strands[i].b]) found.push_back(i);
  }
  return found;
}

/// Whether each tube that still enters the gallbladder lies bare next to it, as far as the view asks and a little more.
bool CholecystectomySurgeon::AreTubesBare(const Snapshot& seen) const {
  if (seen.operation.critical_view.criteria[2] == 2) return true;
  std::vector<std::uint8_t> is_covered(known_.rest.size(), 0);
  for (std::size_t i = 0; i < known_.strands.size(); ++i) {
    const Kind kind = known_.strands[i].kind;
    if (kind != Kind::kTriangle && kind != Kind::kPeritoneum && kind != Kind::kAdhesion) continue;
    if (seen.operation.strand_is_intact[i])
      is_covered[known_.strands[i].a] = is_covered[known_.strands[i].b] = 1;
  }
  return std::all_of(known_.entering.begin(), known_.entering.end(), [&](std::size_t tube) {
    if (IsDivided(seen, tube)) return true;
    const auto& nodes = known_.tube_nodes[tube];
    double length = 0;
    for (std::size_t k = 1; k < nodes.size() && !is_covered[nodes[k]]; ++k)
      length += math::Distance(seen.positions[nodes[k - 1]], seen.positions[nodes[k]]);
    return length >= std::min(kBare, known_.exposable[tube]);
  });
}

bool CholecystectomySurgeon::IsTriangleClear(const Snapshot& seen) const {
  return seen.operation.facts.cleared_share >= kCleared && AreTubesBare(seen);
}

Vec3 CholecystectomySurgeon::BedAxis() const {
  return math::Normalized(known_.rest[known_.fundus] - known_.rest[known_.neck]);
}

bool CholecystectomySurgeon::MayHold(const HoldFilter& may, std::uint32_t node) const {
  if (may.kind == HoldFilter::Kind::kAny) return true;
  const double along = math::Dot(known_.rest[node] - known_.rest[known_.neck], BedAxis());
  if (may.kind == HoldFilter::Kind::kInfundibulum) return along < kInfundibulum;
  if (may.kind == HoldFilter::Kind::kFundus) {
    const double whole = math::Dot(known_.rest[known_.fundus] - known_.rest[known_.neck], BedAxis());
    const double beyond = along - may.peels;
    return along > whole - kInfundibulum || (beyond > kLeastFlap && beyond < kMostFlap);
  }
  const double before = may.peels - along;
  return before > kLeastFlap && before < kMostFlap;
}

/// Bed and adhesions over a share of the bed's length, from the infundibulum on.
std::vector<std::uint32_t> CholecystectomySurgeon::BedStrands(double share) const {
  const Vec3 axis = math::Normalized(known_.rest[known_.fundus] - known_.rest[known_.neck]);
  const auto along = [&](std::uint32_t i) {
    return math::Dot(known_.rest[known_.strands[i].a] - known_.rest[known_.neck], axis);
  };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::uint32_t i = 0; i < known_.strands.size(); ++i) {
    if (known_.strands[i].kind == Kind::kBed)
      first = std::min(first, along(i)), last = std::max(last, along(i));
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < known_.strands.size(); ++i) {
    const bool is_bed = known_.strands[i].kind == Kind::kBed || known_.strands[i].kind == Kind::kAdhesion;
    if (is_bed && along(i) <= first + share * (last - first)) found.push_back(i);
  }
  return found;
}

bool CholecystectomySurgeon::HangsFree(const Snapshot& seen) const {
  return ShareLeft(seen, BedStrands(1.0)) < kOffBed;
}

double CholecystectomySurgeon::ShareLeft(const Snapshot& seen,
                                         const std::vector<std::uint32_t>& strands) const {
  const auto left = std::count_if(strands.begin(), strands.end(),
                                  [&](std::uint32_t i) { return seen.operation.strand_is_intact[i] != 0; });
  return strands.empty() ? 0.0 : static_cast<double>(left) / static_cast<double>(strands.size());
}

TubeLine CholecystectomySurgeon::LineOf(const Snapshot& seen, std::size_t tube) const {
  const patient::Tube& made = scene_->patient.tubes[tube];
  TubeLine line{{}, made.line.radii};
  if (known_.surfaces[scene_->patient.organs.size() + tube].ends[1] == known_.gallbladder)
    std::reverse(line.radii.begin(), line.radii.end());
  for (const std::uint32_t node : known_.tube_nodes[tube]) line.points.push_back(seen.positions[node]);
  return line;
}

std::vector<TubeLine> CholecystectomySurgeon::LinesOf(const Snapshot& seen) const {
  std::vector<TubeLine> lines;
  for (std::size_t t = 0; t < known_.tube_nodes.size(); ++t) lines.push_back(LineOf(seen, t));
  return lines;
}

/// Arcs of the clips on a tube, ascending.
std::vector<double> CholecystectomySurgeon::ClipsOn(const Snapshot& seen, std::size_t tube) const {
  std::vector<double> arcs;
  const std::vector<TubeLine> lines = LinesOf(seen);
  for (std::size_t i = 0; i < seen.operation.clip_count; ++i) {
    const ClipSnapshot& clip = seen.operation.clips[i];
    if (clip.is_lost) continue;
    const auto distance_to = [&](const TubeLine& line) {
      return line.FindNearest(clip.X_world_clip.translation).distance;
    };
    const auto nearest = std::min_element(
        lines.begin(), lines.end(),
        [&](const TubeLine& a, const TubeLine& b) { return distance_to(a) < distance_to(b); });
    if (static_cast<std::size_t>(nearest - lines.begin()) == tube)
      arcs.push_back(nearest->FindNearest(clip.X_world_clip.translation).arc);
  }
  std::sort(arcs.begin(), arcs.end());
  return arcs;
}

bool CholecystectomySurgeon::IsDivided(const Snapshot& seen, std::size_t tube) const {
  return seen.operation.topology.IsDivided(known_.surfaces, scene_->patient.organs.size() + tube);
}

double CholecystectomySurgeon::Clearance(const Snapshot& seen, const collision::Segment& segment) {
  const auto positions = [&](std::size_t i) {
    return std::span(seen.positions).subspan(known_.surfaces[i].first_node, known_.surfaces[i].node_count);
  };
  if (trees_tick_ != seen.tick) {
    trees_tick_ = seen.tick;
    for (std::size_t i = 0; i < trees_.size(); ++i) trees_[i].Update(positions(i));
  }
  constexpr double kFar = 0.03;  // [m]
  double least = kFar;
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    const auto contact = trees_[i].FindNearestToSegment(positions(i), segment, {.max_distance = least});
    if (contact.nearest.Found()) least = std::min(least, std::sqrt(contact.nearest.squared_distance));
  }
  return least;
}

DivisionField CholecystectomySurgeon::FieldOf(const Snapshot& seen, std::size_t tube,
                                              const std::vector<TubeLine>& lines, double care) {
  DivisionField field;
  field.care = care;
  field.tube = &lines[tube];
  for (std::size_t other = 0; other < lines.size(); ++other) {
    // a stump gives way
    if (other == tube || (care < 1.0 && IsDivided(seen, other))) continue;
    field.others.push_back(&lines[other]);
  }
  field.port = HandOf(instrument::kRight).Port();
  field.applier = instrument::FindTool("clip_applier");
  field.scissors = instrument::FindTool("scissors");
  field.clearance = [this, &seen](const collision::Segment& segment) { return Clearance(seen, segment); };
  return field;
}

/// A node of the gallbladder that a grasper can take without the liver, some way off what lies at `near`.
std::uint32_t CholecystectomySurgeon::FindHold(const Snapshot& seen, const Vec3& near,
                                               const std::vector<std::uint32_t>& avoid,
                                               const HoldFilter& may) {
  const auto gallbladder = static_cast<std::size_t>(known_.gallbladder),
             liver = static_cast<std::size_t>(known_.liver);
  const scene::SurfaceInfo& surface = known_.surfaces[gallbladder];
  std::vector<Vec3> normals(surface.node_count);
  for (const auto& triangle : surface.triangles) {
    const Vec3 &a = seen.positions[surface.first_node + triangle[0]],
               &b = seen.positions[surface.first_node + triangle[1]],
               &c = seen.positions[surface.first_node + triangle[2]];
    for (const auto corner : triangle) normals[corner] += math::Cross(b - a, c - a);
  }
  (void)Clearance(seen, {near, near});  // brings the trees up to date
  const auto positions =
      std::span(seen.positions).subspan(known_.surfaces[liver].first_node, known_.surfaces[liver].node_count);
  const double length = scene_->instruments[instrument::kLeft].tool.jaw_length;
  std::uint32_t best = known_.hold;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    const std::uint32_t node = surface.first_node + i;
    if (!MayHold(may, node)) continue;
    const Vec3& p = seen.positions[node];
    const double away = math::Distance(p, near);
    if (away < kLeastAway || away > kMostAway) continue;
    if (std::any_of(avoid.begin(), avoid.end(), [&](std::uint32_t other) {
          return math::Distance(seen.positions[other], p) < kSameHold;
        }))
      continue;
    const Vec3 out = math::Normalized(HandOf(instrument::kLeft).Port() - p);
    const double facing = math::Dot(math::Normalized(normals[i]), out);
    if (facing < 0.1) continue;
    const collision::Segment jaws{p - kJawsBeyond * out, p + (length - kJawsBeyond) * out};
    const auto nearest =
        trees_[liver].FindNearestToSegment(positions, jaws, {.max_distance = kHoldClear}).nearest;
    const double clear = nearest.Found() ? std::sqrt(nearest.squared_distance) : kHoldClear;
    // the shaft has to come there past the gallbladder's own body
    const double way = std::min(kShaftClear, Clearance(seen, {p + 0.4 * length * out, p + kShaftWay * out}));
    const double worth = 3.0 * clear + 2.0 * way + kFacing * facing - 0.3 * std::fabs(away - kHoldAway);
    if (worth <= best_worth) continue;
    best_worth = worth;
    best = node;
  }
  return best;
}

}  // namespace trocar::agent
