// SPDX-License-Identifier: Apache-2.0
#include "operation/vessel_work.h"

#include <algorithm>
#include <cmath>

#include "trocar/collision/segment_distance.h"
#include "trocar/math/state_fields.h"

namespace trocar::simulation {
namespace {

/// A vessel is caught when its axis is this near to the line of the closed jaws, beside its radius [m].
constexpr double kCatch = 0.0015;
/// Width of a clip along the vessel: two that are nearer lie over each other [m].
constexpr double kClipWidth = 0.0012;
constexpr double kDrawnAway = 0.004;    // a vessel that is farther from the closed jaws is out of them [m]
constexpr double kClipHeight = 0.0012;  // of its middle over what it lies on, when it is lost [m]
constexpr double kClosedGap = 0.0006;   // between the legs of a clip [m]
/// Heat seals vessels up to this radius inside [m]: a millimetre across is held to be safe, more is not.
constexpr double kMostSealed = 0.0009;
constexpr double kTight = 0.999;  // closure of a clip
/// Bile left in a gallbladder that cannot run out, as a share of what there was.
constexpr double kLeastFilling = 0.1;

}  // namespace

core::Result<VesselWork> VesselWork::Make(const anatomy::Patient& patient,
                                          std::span<const SurfaceInfo> surfaces, std::uint32_t first_spare,
                                          std::uint32_t spare_count) {
  auto map = MakeVesselMap(patient);
  if (!map.ok()) return map.error();
  VesselWork made(std::move(*map), first_spare, spare_count);
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    const geometry::CentreLine& line = patient.tubes[t].line;
    made.rest_.push_back(line.points);
    made.tubes_.AddTube(surfaces[t].first_node, line.points, line.radii);
    made.tube_of_.insert(made.tube_of_.end(), line.points.size(), t);
    made.arc_of_.insert(made.arc_of_.end(), made.map_.arcs[t].begin(), made.map_.arcs[t].end());
  }
  made.tube_of_.reserve(made.tube_of_.size() + spare_count);
  made.arc_of_.reserve(made.arc_of_.size() + spare_count);
  made.clips_.reserve(surgery::VesselActs::kMostClips);
  made.ends_.reserve(surgery::VesselActs::kMostOpenings);
  return made;
}

std::size_t VesselWork::Cut(const surgery::BladeMove& move, const tissue::TissueDefinition& definition,
                            std::span<const Vec3> position, surgery::TopologyChange& change,
                            std::span<TubePlace> places) noexcept {
  std::array<geometry::CentreLineCut, surgery::CuttableTubes::kMostCuts> cuts;
  const std::size_t room = surgery::VesselActs::kMostOpenings - acts_.openings.size();
  const std::size_t count = tubes_.Cut(move, definition, position, change,
                                       std::span(cuts).first(std::min({room, cuts.size(), places.size()})));
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::CentreLineCut& cut = cuts[i];
    const double arc = arc_of_[cut.a] + cut.t * (arc_of_[cut.b] - arc_of_[cut.a]);
    const std::uint32_t tube = tube_of_[cut.a];
    for (int end = 0; end < 2; ++end) tube_of_.push_back(tube), arc_of_.push_back(arc);
    MoveClips(cut);
    const VesselPlace place = map_.Find(tube, arc);
    acts_.openings.push_back({place.vessel, place.position, true, 0.0, {}});
    ends_.push_back({cut.ends, {tube, arc}});
    places[i] = {tube, arc};
  }
  return count;
}

void VesselWork::MoveClips(const geometry::CentreLineCut& cut) noexcept {
  for (Clipped& clip : clips_) {
    if (clip.is_lost || clip.a != cut.a || clip.b != cut.b) continue;
    if (clip.t < cut.t) {
      clip.b = cut.ends[0];
      clip.t /= cut.t;
    } else {
      clip.a = cut.ends[1];
      clip.t = (clip.t - cut.t) / (1.0 - cut.t);
    }
  }
}

Vec3 VesselWork::RestPoint(const TubePlace& place) const noexcept {
  const std::vector<double>& arcs = map_.arcs[place.tube];
  const std::vector<Vec3>& points = rest_[place.tube];
  std::size_t i = 1;
  while (i + 1 < arcs.size() && arcs[i] < place.arc) ++i;
  return math::Lerp(points[i - 1], points[i],
                    std::clamp((place.arc - arcs[i - 1]) / (arcs[i] - arcs[i - 1]), 0.0, 1.0));
}

std::optional<VesselWork::Caught> VesselWork::Catch(const instrument::Tool& tool, const Pose& X_world_tool,
                                                    double jaw,
                                                    std::span<const Vec3> position) const noexcept {
  const Vec3 hinge = X_world_tool * instrument::JawHinge(tool);
  const Vec3 tip = X_world_tool * instrument::JawTip(tool, 0.0, +1);
  const auto& graph = tubes_.Graph();
  double best = std::numeric_limits<double>::infinity();
  std::optional<Caught> caught;
  for (const geometry::Edge& edge : graph.edges) {
    const collision::Segment axis{position[tubes_.Node(edge[0])], position[tubes_.Node(edge[1])]};
    const auto near = collision::FindNearestSegmentSegment({hinge, tip}, axis);
    const double distance = std::sqrt(near.squared_distance);
    const double radius = std::lerp(graph.radii[edge[0]], graph.radii[edge[1]], near.parameter_b);
    const double half = near.parameter_a * tool.jaw_length * std::sin(0.5 * jaw);
    if (distance > std::max(half, radius + kCatch) || distance >= best) continue;
    best = distance;
    caught = Caught{edge[0], edge[1], near.parameter_b, near.parameter_a, radius};
  }
  return caught;
}

ClipResult VesselWork::Clip(const instrument::Tool& tool, const Pose& X_world_tool,
                            const std::optional<Caught>& caught, std::span<const Vec3> position) noexcept {
  const Vec3 hinge = X_world_tool * instrument::JawHinge(tool);
  const Vec3 tip = X_world_tool * instrument::JawTip(tool, 0.0, +1);
  const auto& edges = tubes_.Graph().edges;
  ClipResult result;
  if (clips_.size() == surgery::VesselActs::kMostClips) return result;
  Clipped clip;
  clip.legs = math::Normalized(tip - hinge);
  clip.gap = kClosedGap;
  clip.loose.radius = kClipHeight;
  // what was between the legs may have been cut, or drawn away
  bool is_there = caught && std::any_of(edges.begin(), edges.end(), [&](const geometry::Edge& edge) {
                    return edge[0] == caught->a && edge[1] == caught->b;
                  });
  if (is_there) {
    const Vec3 p = math::Lerp(position[tubes_.Node(caught->a)], position[tubes_.Node(caught->b)], caught->t);
    const double along = math::Dot(p - hinge, clip.legs);
    is_there = math::Distance(p, hinge + std::clamp(along, 0.0, tool.jaw_length) * clip.legs) < kDrawnAway;
  }
  if (!is_there) {
    clip.is_lost = true;
    clip.loose.position = clip.loose.anchor = tip;
    clips_.push_back(clip);
    return result;
  }
  // how much of the flattened vessel lies between the jaws: it is pi r wide
  const double length = math::Distance(hinge, tip), half = 0.5 * M_PI * caught->radius;
  const double from = caught->jaw_at * length - half, to = caught->jaw_at * length + half;
  const double inside = std::max(0.0, std::min(to, length) - std::max(from, 0.0));
  const double closure = std::clamp(inside / (2.0 * half), 0.0, 1.0);
  clip.a = caught->a, clip.b = caught->b, clip.t = caught->t;
  clip.place = {tube_of_[clip.a], std::lerp(arc_of_[clip.a], arc_of_[clip.b], clip.t)};
  for (Clipped& other : clips_) {
    if (!other.is_lost && other.place.tube == clip.place.tube &&
        std::fabs(other.place.arc - clip.place.arc) < kClipWidth)
      result.is_crossed = other.is_weak = true;
  }
  const VesselPlace place = map_.Find(clip.place.tube, clip.place.arc);
  clip.act = static_cast<std::uint32_t>(acts_.clips.size());
  acts_.clips.push_back({place.vessel, place.position, closure});
  result.place = clip.place;
  clip.closure = closure;
  clip.is_crossed = clip.is_weak = result.is_crossed;
  clip.vessel_radius = caught->radius;
  result.kind = closure < 0.999 ? ClipResult::Kind::kPartial : ClipResult::Kind::kClosed;
  clips_.push_back(clip);
  return result;
}

bool VesselWork::MakeHole(std::uint32_t node, double area, TubePlace& place) noexcept {
  const auto& graph = tubes_.Graph();
  if (acts_.openings.size() == surgery::VesselActs::kMostOpenings) return false;
  for (std::uint32_t p = 0; p < graph.rest.size(); ++p) {
    if (tubes_.Node(p) != node) continue;
    place = {tube_of_[p], arc_of_[p]};
    const VesselPlace at = map_.Find(place.tube, place.arc);
    acts_.openings.push_back({at.vessel, at.position, false, area, {}});
    ends_.push_back({{p, p}, place});
    return true;
  }
  return false;
}

void VesselWork::Seal(const Vec3& p, double reach, double share, std::span<const Vec3> position) noexcept {
  for (std::size_t i = 0; i < acts_.openings.size(); ++i) {
    if (map_.network.Vessels()[acts_.openings[i].vessel].radius > kMostSealed) continue;
    for (std::size_t end = 0; end < 2; ++end) {
      if (math::Distance(position[tubes_.Node(ends_[i].points[end])], p) > reach) continue;
      double& sealed = acts_.openings[i].sealed[end];
      sealed = std::min(1.0, sealed + share);
    }
  }
}

void VesselWork::Flow(double seconds, std::int32_t hollow, tissue::ConservationState& conserved,
                      surgery::FluidLedger& ledger) noexcept {
  report_ = {};
  if (acts_.openings.empty()) return;
  tissue::OrganVolume* organ = hollow >= 0 ? &conserved.organs[static_cast<std::size_t>(hollow)] : nullptr;
  if (organ != nullptr) {
    for (const std::uint32_t j : map_.gallbladder_ducts)
      map_.network.SetPressure(j, std::clamp(organ->pressure, 0.0, 20e3));
  }
  report_ = map_.network.Solve(acts_);
  for (const surgery::Leak& leak : report_.Leaks()) ledger.Leak(leak.fluid, leak.rate * seconds);
  if (organ == nullptr) return;
  for (const std::uint32_t j : map_.gallbladder_ducts) {
    const double lost = map_.network.SupplyAt(j) * seconds;
    const double before = organ->target + organ->leaked;
    if (lost > 0.0 && organ->target - lost > kLeastFilling * before)
      organ->target -= lost, organ->leaked += lost;
  }
}

std::size_t VesselWork::CountCuts(std::uint32_t tube) const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < ends_.size(); ++i)
    count += acts_.openings[i].is_cut && ends_[i].place.tube == tube ? 1 : 0;
  return count;
}

void VesselWork::Publish(std::span<const Vec3> position, std::size_t organ_count,
                         OperationSnapshot& snapshot) const noexcept {
  const auto& graph = tubes_.Graph();
  snapshot.tube_piece_count = std::min(graph.edges.size(), snapshot.tube_pieces.size());
  for (std::size_t e = 0; e < snapshot.tube_piece_count; ++e) {
    const auto& edge = graph.edges[e];
    snapshot.tube_pieces[e] = {tubes_.Node(edge[0]), tubes_.Node(edge[1]), graph.radii[edge[0]],
                               graph.radii[edge[1]],
                               static_cast<std::uint32_t>(organ_count) + tube_of_[edge[0]]};
  }
  snapshot.clip_count = std::min(clips_.size(), snapshot.clips.size());
  for (std::size_t i = 0; i < snapshot.clip_count; ++i) {
    const Clipped& clip = clips_[i];
    ClipSnapshot& shown = snapshot.clips[i];
    shown.is_lost = clip.is_lost;
    shown.gap = clip.gap;
    shown.is_crossed = clip.is_crossed;
    shown.closure = clip.closure;
    if (clip.is_lost) {
      shown.X_world_clip = {math::Quaternion{}, clip.loose.position};
      continue;
    }
    shown.p_rest = RestPoint(clip.place);
    const Vec3 &a = position[tubes_.Node(clip.a)], &b = position[tubes_.Node(clip.b)];
    const Vec3 z = math::Normalized(b - a);
    const Vec3 x = math::Normalized(clip.legs - z * math::Dot(clip.legs, z), {1, 0, 0});
    shown.X_world_clip = {math::RotationFromAxes(x, math::Cross(z, x), z), math::Lerp(a, b, clip.t)};
  }
  snapshot.tube_cut_count = 0;
  for (std::size_t i = 0; i < ends_.size() && snapshot.tube_cut_count < snapshot.tube_cuts.size(); ++i) {
    if (acts_.openings[i].is_cut) snapshot.tube_cuts[snapshot.tube_cut_count++] = RestPoint(ends_[i].place);
  }
  snapshot.leak_count = 0;
  for (const surgery::Leak& leak : report_.Leaks()) {
    if (snapshot.leak_count == snapshot.leaks.size()) break;
    const OpeningEnds& ends = ends_[leak.opening];
    const std::uint32_t point = ends.points[leak.end];
    // away from the piece that ends here
    Vec3 out{0, 0, 1};
    for (const auto& edge : graph.edges) {
      if (edge[0] == point) out = position[tubes_.Node(point)] - position[tubes_.Node(edge[1])];
      if (edge[1] == point) out = position[tubes_.Node(point)] - position[tubes_.Node(edge[0])];
    }
    snapshot.leaks[snapshot.leak_count++] = {position[tubes_.Node(point)], math::Normalized(out, {0, 0, 1}),
                                             leak.fluid, leak.rate};
  }
}

/// The side that stays is the one that joins another tube, or comes from the liver.
VesselJudgement VesselWork::JudgePlace(const TubePlace& place) const noexcept {
  const VesselPlace at = map_.Find(place.tube, place.arc);
  const auto& junctions = map_.anatomy.gallbladder;
  const bool is_gallbladder_at_from = std::find(junctions.begin(), junctions.end(),
                                                map_.network.Vessels()[at.vessel].from) != junctions.end();
  const auto stays = [&](const surgery::VesselClip& clip) {
    return clip.vessel == at.vessel && clip.closure >= kTight &&
           (clip.position > at.position) == is_gallbladder_at_from;
  };
  return {training::MayBeDivided(map_.anatomy.roles[at.vessel]),
          static_cast<int>(std::count_if(acts_.clips.begin(), acts_.clips.end(), stays)),
          CountCuts(place.tube)};
}

void VesselWork::VisitTopology(core::StateArchive& archive) {
  archive.Field("tubes", tubes_);
  archive.Field("tube_of", tube_of_);
  archive.Field("arc_of", arc_of_);
  if (archive.IsRestoring() && archive.ok() &&
      (tube_of_.size() != tubes_.Graph().rest.size() || arc_of_.size() != tube_of_.size() ||
       std::any_of(tube_of_.begin(), tube_of_.end(), [&](std::uint32_t t) { return t >= rest_.size(); })))
    archive.Fail("has points of no tube");
}

void VesselWork::VisitState(core::StateArchive& archive) {
  archive.Field("network", map_.network);
  archive.Field("acts", acts_);
  archive.Field("clips", clips_);
  archive.Field("ends", ends_);
  archive.Field("report", report_);
  if (!archive.IsRestoring() || !archive.ok()) return;
  const std::size_t points = tube_of_.size();
  const auto fits = [&](const Clipped& clip) {
    return clip.a < points && clip.b < points && clip.place.tube < rest_.size() &&
           (clip.is_lost || clip.act < acts_.clips.size());
  };
  const auto is_end = [&](const OpeningEnds& end) {
    return end.points[0] < points && end.points[1] < points && end.place.tube < rest_.size();
  };
  const auto is_leak = [&](const surgery::Leak& leak) { return leak.opening < ends_.size() && leak.end < 2; };
  const auto leaks = report_.Leaks();
  if (clips_.size() > surgery::VesselActs::kMostClips || ends_.size() != acts_.openings.size() ||
      !std::all_of(clips_.begin(), clips_.end(), fits) || !std::all_of(ends_.begin(), ends_.end(), is_end) ||
      !std::all_of(leaks.begin(), leaks.end(), is_leak))
    archive.Fail("has clips or openings of no duct or vessel");
}

void VesselWork::Clipped::VisitState(core::StateArchive& archive) {
  archive.Field("a", a);
  archive.Field("b", b);
  archive.Field("t", t);
  archive.Field("legs", legs);
  archive.Field("gap", gap);
  archive.Field("is_lost", is_lost);
  archive.Field("is_crossed", is_crossed);
  archive.Field("closure", closure);
  archive.Field("is_weak", is_weak);
  archive.Field("vessel_radius", vessel_radius);
  archive.Field("act", act);
  archive.Field("loose_radius", loose.radius);
  archive.Field("loose", loose);
  archive.Field("tube", place.tube);
  archive.Field("arc", place.arc);
}

void VesselWork::OpeningEnds::VisitState(core::StateArchive& archive) {
  archive.Field("points", points);
  archive.Field("tube", place.tube);
  archive.Field("arc", place.arc);
}

void VesselWork::Caught::VisitState(core::StateArchive& archive) {
  archive.Field("a", a);
  archive.Field("b", b);
  archive.Field("t", t);
  archive.Field("jaw_at", jaw_at);
  archive.Field("radius", radius);
}

}  // namespace trocar::simulation
