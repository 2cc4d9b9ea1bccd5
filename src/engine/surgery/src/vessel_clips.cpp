// SPDX-License-Identifier: Apache-2.0
// Clips: what lies between the legs, and those that slip off the end of what was cut: along the stump, towards the cut, under
// pressure and pull.
#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/collision/segment_distance.h"
#include "trocar/math/elementary.h"
#include "trocar/surgery/clip_hold.h"
#include "trocar/surgery/vessels.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

constexpr double kTight = 0.999;  // closure that keeps the pressure from the next clip

}  // namespace

std::optional<Vessels::Caught> Vessels::Catch(const instrument::Tool& tool, const math::Pose& X_world_tool,
                                              double jaw, std::span<const Vec3> position) const noexcept {
  const Vec3 hinge = X_world_tool * instrument::JawHinge(tool);
  const Vec3 tip = X_world_tool * instrument::JawTip(tool, 0.0, +1);
  const auto& graph = tubes_.Graph();
  double best = std::numeric_limits<double>::infinity();
  std::optional<Caught> caught;
  for (const geometry::Edge& edge : graph.edges) {
    const collision::Segment axis{position[tubes_.Node(edge[0])], position[tubes_.Node(edge[1])]};
    const auto near = collision::FindNearestSegmentSegment({hinge, tip}, axis);
    const double distance = std::sqrt(near.squared_distance);
    const double radius = math::Lerp(graph.radii[edge[0]], graph.radii[edge[1]], near.parameter_b);
    const double half = near.parameter_a * tool.jaw_length * math::Sin(0.5 * jaw);
    if (distance > std::max(half, radius + settings_.clip_shape.catch_beside) || distance >= best) continue;
    best = distance;
    caught = Caught{edge[0], edge[1], near.parameter_b, near.parameter_a, radius};
  }
  return caught;
}

ClipResult Vessels::Clip(const instrument::Tool& tool, const math::Pose& X_world_tool,
                         const std::optional<Caught>& caught, std::span<const Vec3> position) noexcept {
  const Vec3 hinge = X_world_tool * instrument::JawHinge(tool);
  const Vec3 tip = X_world_tool * instrument::JawTip(tool, 0.0, +1);
  const auto& edges = tubes_.Graph().edges;
  ClipResult result;
  if (clips_.size() == VesselActs::kMostClips) return result;
  Clipped clip;
  clip.legs = math::Normalized(tip - hinge);
  clip.gap = settings_.clip_shape.gap;
  clip.loose.radius = settings_.clip_shape.height;
  // what was between the legs may have been cut, or drawn away
  bool is_there = caught && std::any_of(edges.begin(), edges.end(), [&](const geometry::Edge& edge) {
                    return edge[0] == caught->a && edge[1] == caught->b;
                  });
  if (is_there) {
    const Vec3 p = math::Lerp(position[tubes_.Node(caught->a)], position[tubes_.Node(caught->b)], caught->t);
    const double along = math::Dot(p - hinge, clip.legs);
    is_there = math::Distance(p, hinge + std::clamp(along, 0.0, tool.jaw_length) * clip.legs) <
               settings_.clip_shape.drawn_away;
  }
  if (!is_there) {
    clip.is_lost = true;
    clip.loose.position = clip.loose.anchor = tip;
    clips_.push_back(clip);
    return result;
  }
  clip.a = caught->a, clip.b = caught->b, clip.t = caught->t;
  clip.place = {tube_of_[clip.a], math::Lerp(arc_of_[clip.a], arc_of_[clip.b], clip.t)};
  for (Clipped& other : clips_) {
    if (!other.is_lost && other.place.tube == clip.place.tube &&
        std::fabs(other.place.arc - clip.place.arc) < settings_.clip_shape.width)
      result.is_crossed = other.is_weak = true;
  }
  Fasten(clip, *caught, math::Distance(hinge, tip), result);
  return result;
}

/// Closes the tube at the clip's place as far as the jaws reach over it.
/// \param length  of the jaws [m]
void Vessels::Fasten(Clipped& clip, const Caught& caught, double length, ClipResult& result) noexcept {
  // how much of the flattened vessel lies between the jaws: it is pi r wide
  const double half = 0.5 * M_PI * caught.radius;
  const double from = caught.jaw_at * length - half, to = caught.jaw_at * length + half;
  const double inside = std::max(0.0, std::min(to, length) - std::max(from, 0.0));
  const double closure = std::clamp(inside / (2.0 * half), 0.0, 1.0);
  const VesselPlace place = map_.Find(clip.place.tube, clip.place.arc);
  clip.act = static_cast<std::uint32_t>(acts_.clips.size());
  acts_.clips.push_back({place.vessel, place.position, closure});
  result.place = clip.place;
  clip.closure = closure;
  clip.is_crossed = clip.is_weak = result.is_crossed;
  clip.vessel_radius = caught.radius;
  result.kind = closure < kTight ? ClipResult::Kind::kPartial : ClipResult::Kind::kClosed;
  clips_.push_back(clip);
}

std::size_t Vessels::CatchBetween(const instrument::Tool& tool, const math::Pose& X_world_tool,
                                  std::span<const Vec3> position, std::span<Caught> caught) const noexcept {
  const collision::Segment jaws{X_world_tool * instrument::JawHinge(tool),
                                X_world_tool * instrument::JawTip(tool, 0.0, +1)};
  const auto& graph = tubes_.Graph();
  std::size_t count = 0;
  for (std::uint32_t tube = 0; tube < rest_.size() && count < caught.size(); ++tube) {
    double best = std::numeric_limits<double>::infinity();
    for (const geometry::Edge& edge : graph.edges) {
      if (tube_of_[edge[0]] != tube) continue;
      const auto near = collision::FindNearestSegmentSegment(
          jaws, {position[tubes_.Node(edge[0])], position[tubes_.Node(edge[1])]});
      const double distance = std::sqrt(near.squared_distance);
      const double radius = math::Lerp(graph.radii[edge[0]], graph.radii[edge[1]], near.parameter_b);
      if (distance > radius + settings_.clip_shape.catch_beside || distance >= best) continue;
      best = distance;
      caught[count] = Caught{edge[0], edge[1], near.parameter_b, near.parameter_a, radius};
    }
    if (best < std::numeric_limits<double>::infinity()) ++count;
  }
  return count;
}

ClipResult Vessels::Staple(const instrument::Tool& tool, const math::Pose& X_world_tool, const Caught& caught,
                           double offset) noexcept {
  ClipResult result;
  Clipped row;
  row.place = {tube_of_[caught.a], math::Lerp(arc_of_[caught.a], arc_of_[caught.b], caught.t) + offset};
  const std::vector<double>& arcs = map_.arcs[row.place.tube];
  if (clips_.size() == VesselActs::kMostClips || row.place.arc <= arcs.front() ||
      row.place.arc >= arcs.back())
    return result;
  row.legs = math::Rotate(X_world_tool.rotation, {0, 0, -1});
  row.gap = settings_.clip_shape.gap;
  row.loose.radius = settings_.clip_shape.height;
  row.a = caught.a, row.b = caught.b, row.t = caught.t;
  FindEdge(row);
  Fasten(row, caught, tool.jaw_length, result);
  return result;
}

/// Pull of the hands that hold the stump at a clip, or between it and its free end, along the vessel [N].
double Vessels::CalcPull(const Clipped& clip, const Stump& stump, std::span<const Vec3> position,
                         std::span<const ClipPull> pulls) const noexcept {
  const Vec3 off =
      stump.sign * math::Normalized(position[tubes_.Node(clip.b)] - position[tubes_.Node(clip.a)]);
  const double free = stump.sign * (stump.cut - acts_.clips[clip.act].position);
  double pull = 0;
  for (const ClipPull& hand : pulls) {
    const auto is_held = [&](std::uint32_t p) {
      const double beyond = stump.sign * (arc_of_[p] - clip.place.arc);
      return tube_of_[p] == clip.place.tube && beyond > -settings_.clip_shape.pulled_before &&
             beyond <= free &&
             std::find(hand.nodes.begin(), hand.nodes.end(), tubes_.Node(p)) != hand.nodes.end();
    };
    bool is_pulled = false;
    for (std::uint32_t p = 0; p < tube_of_.size() && !hand.nodes.empty(); ++p)
      is_pulled = is_pulled || is_held(p);
    if (is_pulled) pull += std::max(0.0, math::Dot(hand.force, off));
  }
  return pull;
}

/// Puts a clip where its place says, on the side of the cut that it is on.
void Vessels::FindEdge(Clipped& clip) noexcept {
  const auto& edges = tubes_.Graph().edges;
  for (const geometry::Edge& edge : edges) {
    if (tube_of_[edge[0]] != clip.place.tube) continue;
    const double from = arc_of_[edge[0]], to = arc_of_[edge[1]];
    if (!(clip.place.arc >= std::min(from, to)) || !(clip.place.arc <= std::max(from, to))) continue;
    clip.a = edge[0], clip.b = edge[1];
    clip.t = to != from ? (clip.place.arc - from) / (to - from) : 0.0;
    return;
  }
}

std::size_t Vessels::SlipStump(const Stump& stump, double seconds, std::span<const ClipPull> pulls,
                               std::span<const Vec3> position, std::span<SlippedClip> slipped) noexcept {
  // those on the stump, from where the pressure comes to the cut
  std::array<Clipped*, VesselActs::kMostClips> row;
  std::size_t count = 0;
  const auto along = [&](const Clipped& clip) { return stump.sign * acts_.clips[clip.act].position; };
  for (Clipped& clip : clips_) {
    if (clip.is_lost || acts_.clips[clip.act].vessel != stump.vessel) continue;
    const double at = along(clip);
    if (at > stump.sign * stump.cut || at < stump.sign * stump.root) continue;
    std::size_t i = count++;
    for (; i > 0 && along(*row[i - 1]) > at; --i) row[i] = row[i - 1];
    row[i] = &clip;
  }
  std::array<double, VesselActs::kMostClips> speed{};
  double pressure = stump.pressure;
  for (std::size_t i = 0; i < count; ++i) {
    const Clipped& clip = *row[i];
    const double pull = CalcPull(clip, stump, position, pulls);
    // a clip that moves takes along those that it runs into
    ClipHold hold;
    std::size_t end = i;
    for (; end < count && (end == i || along(*row[end]) - along(*row[end - 1]) <= settings_.clip_shape.width);
         ++end) {
      const Clipped& member = *row[end];
      const ClipHold own =
          CalcClipHold({member.closure, member.is_weak, member.vessel_radius}, settings_.clips);
      hold.pressure += own.pressure, hold.pull += own.pull;
    }
    const double slip = CalcSlipSpeed(CalcClipLoad(hold, pressure, pull), settings_.clips);
    for (std::size_t k = i; k < end; ++k) speed[k] = std::max(speed[k], slip);
    if (clip.closure >= kTight) pressure = 0.0;
  }
  std::size_t fallen = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(speed[i] > 0.0)) continue;
    Clipped& clip = *row[i];
    VesselClip& act = acts_.clips[clip.act];
    const double way = stump.sign * speed[i] * seconds;
    act.position += way;
    clip.place.arc += way;
    FindEdge(clip);
    if (std::fabs(stump.cut - act.position) > 0.5 * settings_.clip_shape.width &&
        stump.sign * (stump.cut - act.position) > 0.0)
      continue;
    if (fallen == slipped.size()) continue;  // in the next tick
    act.closure = 0.0;
    clip.is_lost = true;
    clip.loose.position = math::Lerp(position[tubes_.Node(clip.a)], position[tubes_.Node(clip.b)], clip.t);
    clip.loose.anchor = clip.loose.position;
    slipped[fallen++] = {clip.place, clip.loose.position};
  }
  return fallen;
}

std::size_t Vessels::Slip(double seconds, std::span<const ClipPull> pulls, std::span<const Vec3> position,
                          std::span<SlippedClip> slipped) noexcept {
  std::size_t count = 0;
  const auto vessels = map_.network.Vessels();
  for (const VesselOpening& opening : acts_.openings) {
    if (!opening.is_cut) continue;
    for (const double sign : {1.0, -1.0}) {
      const FlowVessel& vessel = vessels[opening.vessel];
      Stump stump{opening.vessel, sign, opening.position, sign > 0 ? 0.0 : vessel.length, 0.0};
      // a piece between two cuts is fed by nothing
      bool is_fed = true;
      for (const VesselOpening& other : acts_.openings) {
        if (&other == &opening || !other.is_cut || other.vessel != opening.vessel) continue;
        is_fed = is_fed && sign * (other.position - opening.position) > 0.0;
      }
      if (!is_fed) continue;
      const double supply = map_.network.PressureAt(sign > 0 ? vessel.from : vessel.to);
      stump.pressure = std::isfinite(supply) ? std::max(0.0, supply) : 0.0;
      count += SlipStump(stump, seconds, pulls, position, slipped.subspan(count));
    }
  }
  return count;
}

void Vessels::FindLooseClips(std::vector<LooseStone*>& loose) noexcept {
  for (Clipped& clip : clips_) {
    if (clip.is_lost && loose.size() < loose.capacity()) loose.push_back(&clip.loose);
  }
}

}  // namespace trocar::surgery
