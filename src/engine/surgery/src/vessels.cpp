// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/vessels.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Vec3;

Vessels::Vessels(VesselMap map, std::span<const VesselTube> tubes, std::uint32_t first_spare,
                 std::uint32_t spare_count, const VesselSettings& settings)
    : settings_(settings), map_(std::move(map)), tubes_(first_spare, spare_count) {
  for (std::uint32_t t = 0; t < tubes.size(); ++t) {
    const VesselTube& tube = tubes[t];
    rest_.emplace_back(tube.points.begin(), tube.points.end());
    tubes_.AddTube(tube.first_node, tube.points, tube.radii);
    tube_of_.insert(tube_of_.end(), tube.points.size(), t);
    arc_of_.insert(arc_of_.end(), map_.arcs[t].begin(), map_.arcs[t].end());
  }
  tube_of_.reserve(tube_of_.size() + spare_count);
  arc_of_.reserve(arc_of_.size() + spare_count);
  clips_.reserve(VesselActs::kMostClips);
  ends_.reserve(VesselActs::kMostOpenings);
}

std::size_t Vessels::Cut(const BladeMove& move, const tissue::TissueDefinition& definition,
                         std::span<const Vec3> position, TopologyChange& change,
                         std::span<TubePlace> places) noexcept {
  std::array<geometry::CentreLineCut, CuttableTubes::kMostCuts> cuts;
  const std::size_t capacity = VesselActs::kMostOpenings - acts_.openings.size();
  const std::size_t count =
      tubes_.Cut(move, definition, position, change,
                 std::span(cuts).first(std::min({capacity, cuts.size(), places.size()})));
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

void Vessels::MoveClips(const geometry::CentreLineCut& cut) noexcept {
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

Vec3 Vessels::RestPoint(const TubePlace& place) const noexcept {
  const std::vector<double>& arcs = map_.arcs[place.tube];
  const std::vector<Vec3>& points = rest_[place.tube];
  std::size_t i = 1;
  while (i + 1 < arcs.size() && arcs[i] < place.arc) ++i;
  return math::Lerp(points[i - 1], points[i],
                    std::clamp((place.arc - arcs[i - 1]) / (arcs[i] - arcs[i - 1]), 0.0, 1.0));
}

bool Vessels::MakeHole(std::uint32_t node, double area, TubePlace& place) noexcept {
  const auto& graph = tubes_.Graph();
  if (acts_.openings.size() == VesselActs::kMostOpenings) return false;
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

void Vessels::Seal(const Vec3& p, double reach, double share, std::span<const Vec3> position) noexcept {
  for (std::size_t i = 0; i < acts_.openings.size(); ++i) {
    if (map_.network.Vessels()[acts_.openings[i].vessel].radius > settings_.most_sealed_radius) continue;
    for (std::size_t end = 0; end < 2; ++end) {
      if (math::Distance(position[tubes_.Node(ends_[i].points[end])], p) > reach) continue;
      double& sealed = acts_.openings[i].sealed[end];
      sealed = std::min(1.0, sealed + share);
    }
  }
}

void Vessels::Flow(double seconds, std::int32_t hollow, tissue::ConservationState& conserved,
                   FluidLedger& ledger) noexcept {
  report_ = {};
  if (acts_.openings.empty()) return;
  tissue::OrganVolume* organ = hollow >= 0 ? &conserved.organs[static_cast<std::size_t>(hollow)] : nullptr;
  if (organ != nullptr) {
    for (const std::uint32_t j : map_.organ_ducts)
      map_.network.SetPressure(j, std::clamp(organ->pressure, 0.0, 20e3));
  }
  report_ = map_.network.Solve(acts_);
  for (const Leak& leak : report_.Leaks()) ledger.Leak(leak.fluid, leak.rate * seconds);
  if (organ == nullptr) return;
  for (const std::uint32_t j : map_.organ_ducts) {
    const double lost = map_.network.SupplyAt(j) * seconds;
    const double before = organ->target + organ->leaked;
    if (lost > 0.0 && organ->target - lost > settings_.least_filling * before)
      organ->target -= lost, organ->leaked += lost;
  }
}

std::size_t Vessels::CountCuts(std::uint32_t tube) const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < ends_.size(); ++i)
    count += acts_.openings[i].is_cut && ends_[i].place.tube == tube ? 1 : 0;
  return count;
}

std::size_t Vessels::PublishPieces(std::size_t first_surface, std::span<TubePiece> pieces) const noexcept {
  const auto& graph = tubes_.Graph();
  const std::size_t count = std::min(graph.edges.size(), pieces.size());
  for (std::size_t e = 0; e < count; ++e) {
    const auto& edge = graph.edges[e];
    pieces[e] = {tubes_.Node(edge[0]), tubes_.Node(edge[1]), graph.radii[edge[0]], graph.radii[edge[1]],
                 static_cast<std::uint32_t>(first_surface) + tube_of_[edge[0]]};
  }
  return count;
}

std::size_t Vessels::PublishClips(std::span<const Vec3> position,
                                  std::span<ClipSnapshot> clips) const noexcept {
  const std::size_t count = std::min(clips_.size(), clips.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Clipped& clip = clips_[i];
    ClipSnapshot& shown = clips[i];
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
  return count;
}

std::size_t Vessels::PublishCuts(std::span<Vec3> cuts) const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < ends_.size() && count < cuts.size(); ++i) {
    if (acts_.openings[i].is_cut) cuts[count++] = RestPoint(ends_[i].place);
  }
  return count;
}

std::size_t Vessels::PublishLeaks(std::span<const Vec3> position,
                                  std::span<LeakSnapshot> leaks) const noexcept {
  const auto& graph = tubes_.Graph();
  std::size_t count = 0;
  for (const Leak& leak : report_.Leaks()) {
    if (count == leaks.size()) break;
    const OpeningEnds& ends = ends_[leak.opening];
    const std::uint32_t point = ends.points[leak.end];
    // away from the piece that ends here
    Vec3 out{0, 0, 1};
    for (const auto& edge : graph.edges) {
      if (edge[0] == point) out = position[tubes_.Node(point)] - position[tubes_.Node(edge[1])];
      if (edge[1] == point) out = position[tubes_.Node(point)] - position[tubes_.Node(edge[0])];
    }
    leaks[count++] = {position[tubes_.Node(point)], math::Normalized(out, {0, 0, 1}), leak.fluid, leak.rate};
  }
  return count;
}

void Vessels::VisitTopology(base::StateArchive& archive) {
  archive.Field("tubes", tubes_);
  archive.Field("tube_of", tube_of_);
  archive.Field("arc_of", arc_of_);
  if (archive.IsRestoring() && archive.ok() &&
      (tube_of_.size() != tubes_.Graph().rest.size() || arc_of_.size() != tube_of_.size() ||
       std::any_of(tube_of_.begin(), tube_of_.end(), [&](std::uint32_t t) { return t >= rest_.size(); })))
    archive.Fail("has points of no tube");
}

void Vessels::VisitState(base::StateArchive& archive) {
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
  const auto is_leak = [&](const Leak& leak) { return leak.opening < ends_.size() && leak.end < 2; };
  const auto leaks = report_.Leaks();
  if (clips_.size() > VesselActs::kMostClips || ends_.size() != acts_.openings.size() ||
      !std::all_of(clips_.begin(), clips_.end(), fits) || !std::all_of(ends_.begin(), ends_.end(), is_end) ||
      !std::all_of(leaks.begin(), leaks.end(), is_leak))
    archive.Fail("has clips or openings of no duct or vessel");
}

void Vessels::Clipped::VisitState(base::StateArchive& archive) {
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

void Vessels::OpeningEnds::VisitState(base::StateArchive& archive) {
  archive.Field("points", points);
  archive.Field("tube", place.tube);
  archive.Field("arc", place.arc);
}

void Vessels::Caught::VisitState(base::StateArchive& archive) {
  archive.Field("a", a);
  archive.Field("b", b);
  archive.Field("t", t);
  archive.Field("jaw_at", jaw_at);
  archive.Field("radius", radius);
}

}  // namespace trocar::surgery
