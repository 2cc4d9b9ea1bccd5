// SPDX-License-Identifier: Apache-2.0
// Clips that slip off the end of what was cut: along the stump, towards the cut, under pressure and pull.
#include <algorithm>
#include <cmath>

#include "operation/vessel_work.h"
#include "trocar/surgery/clip_hold.h"

namespace trocar::simulation {
namespace {

constexpr double kFallsOff = 0.0006;   // of a clip's middle from the end: half of its width [m]
constexpr double kClipTouch = 0.0012;  // between the middles of two that lie side by side [m]
constexpr double kTight = 0.999;       // closure that keeps the pressure from the next clip
constexpr double kPulledAt = 0.0025;   // before a clip: what is held there holds the clip [m]

}  // namespace

/// Pull of the hands that hold the stump at a clip, or between it and its free end, along the vessel [N].
double VesselWork::CalcPull(const Clipped& clip, const Stump& stump, std::span<const Vec3> position,
                            std::span<const ClipPull> pulls) const noexcept {
  const Vec3 off =
      stump.sign * math::Normalized(position[tubes_.Node(clip.b)] - position[tubes_.Node(clip.a)]);
  const double free = stump.sign * (stump.cut - acts_.clips[clip.act].position);
  double pull = 0;
  for (const ClipPull& hand : pulls) {
    const auto is_held = [&](std::uint32_t p) {
      const double beyond = stump.sign * (arc_of_[p] - clip.place.arc);
      return tube_of_[p] == clip.place.tube && beyond > -kPulledAt && beyond <= free &&
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
void VesselWork::Reseat(Clipped& clip) noexcept {
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

std::size_t VesselWork::SlipStump(const Stump& stump, double seconds, std::span<const ClipPull> pulls,
                                  std::span<const Vec3> position, std::span<SlippedClip> slipped) noexcept {
  // those on the stump, from where the pressure comes to the cut
  std::array<Clipped*, surgery::VesselActs::kMostClips> row;
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
  std::array<double, surgery::VesselActs::kMostClips> speed{};
  double pressure = stump.pressure;
  for (std::size_t i = 0; i < count; ++i) {
    const Clipped& clip = *row[i];
    const double pull = CalcPull(clip, stump, position, pulls);
    // a clip that moves takes along those that it runs into
    surgery::ClipHold hold;
    std::size_t end = i;
    for (; end < count && (end == i || along(*row[end]) - along(*row[end - 1]) <= kClipTouch); ++end) {
      const Clipped& member = *row[end];
      const surgery::ClipHold own =
          surgery::CalcClipHold({member.closure, member.is_weak, member.vessel_radius});
      hold.pressure += own.pressure, hold.pull += own.pull;
    }
    const double slip = surgery::CalcSlipSpeed(surgery::CalcClipLoad(hold, pressure, pull));
    for (std::size_t k = i; k < end; ++k) speed[k] = std::max(speed[k], slip);
    if (clip.closure >= kTight) pressure = 0.0;
  }
  std::size_t fallen = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(speed[i] > 0.0)) continue;
    Clipped& clip = *row[i];
    surgery::VesselClip& act = acts_.clips[clip.act];
    const double way = stump.sign * speed[i] * seconds;
    act.position += way;
    clip.place.arc += way;
    Reseat(clip);
    if (std::fabs(stump.cut - act.position) > kFallsOff && stump.sign * (stump.cut - act.position) > 0.0)
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

std::size_t VesselWork::Slip(double seconds, std::span<const ClipPull> pulls, std::span<const Vec3> position,
                             std::span<SlippedClip> slipped) noexcept {
  std::size_t count = 0;
  const auto vessels = map_.network.Vessels();
  for (const surgery::VesselOpening& opening : acts_.openings) {
    if (!opening.is_cut) continue;
    for (const double sign : {1.0, -1.0}) {
      const surgery::FlowVessel& vessel = vessels[opening.vessel];
      Stump stump{opening.vessel, sign, opening.position, sign > 0 ? 0.0 : vessel.length, 0.0};
      // a piece between two cuts is fed by nothing
      bool is_fed = true;
      for (const surgery::VesselOpening& other : acts_.openings) {
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

void VesselWork::FindLooseClips(std::vector<surgery::LooseStone*>& loose) noexcept {
  for (Clipped& clip : clips_) {
    if (clip.is_lost && loose.size() < loose.capacity()) loose.push_back(&clip.loose);
  }
}

}  // namespace trocar::simulation
