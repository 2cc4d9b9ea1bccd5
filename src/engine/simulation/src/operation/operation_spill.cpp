// SPDX-License-Identifier: Apache-2.0
// What comes out, comes off and comes to lie: stones, slipped clips, blood of the bed.
#include <algorithm>
#include <cmath>

#include "operation/operation.h"

namespace trocar::simulation {

using instrument::kHandCount;
using surgery::FactKind;

namespace {

constexpr double kTornHole = 1e-6;     // of the wall that a torn spring leaves open at each end [m^2]
constexpr double kPushLength = 0.060;  // of a shaft that pushes stones aside [m]

}  // namespace

void Operation::Flow(const HandsNow& hands, OperatedTissue& tissue) noexcept {
  tissue::OrganVolume* const organ =
      anatomy_.organ >= 0 ? &tissue.conserved.organs[static_cast<std::size_t>(anatomy_.organ)] : nullptr;
  if (organ != nullptr) {
    KeepLeaked(*organ);
    const double now = organ->leaked - parts_.wall.leaked_seen;
    if (now > 0.0) parts_.fluids.Leak(surgery::Fluid::kBile, now);
    SpillStones(now, tissue);
  }
  parts_.vessels->Flow(hands.seconds, anatomy_.organ, tissue.conserved, parts_.fluids);
  SlipClips(hands, tissue);
  parts_.fluids.Leak(surgery::Fluid::kBlood,
                     ooze_.Update(tissue.state, parts_.heat, made_->definition.rest.size(), hands.seconds));
  if (organ != nullptr) parts_.wall.leaked_seen = organ->leaked;
  parts_.smoke = std::clamp(parts_.smoke * (1.0 - Suction().smoke_fade * hands.seconds), 0.0, 1.0);
  parts_.retrieval.is_organ_free = attachment_.IsFree(tissue.state, *parts_.vessels);
}

/// A bad tick takes the organ back to the last good solve, and with it the bile that ran out after that solve. It is in the
/// ledger already: it stays out, or it would be counted again when it runs out again.
void Operation::KeepLeaked(tissue::OrganVolume& organ) const noexcept {
  const double back = parts_.wall.leaked_seen - organ.leaked;
  if (!(back > 0.0)) return;
  organ.target -= back;
  organ.leaked = parts_.wall.leaked_seen;
}

void Operation::SpillStones(double leaked, const OperatedTissue& tissue) noexcept {
  if (anatomy_.organ < 0) return;
  for (const std::uint32_t i : tissue.torn_springs) {
    const tissue::Spring& spring = tissue.definition.springs[i];
    for (const std::uint32_t node : {spring.a, spring.b}) {
      if (IsOf(node, anatomy_.organ)) parts_.wall.holes.Add(node, 2.0 * std::sqrt(M_PI * kTornHole));
    }
  }
  if (!(leaked > 0.0) || parts_.retrieval.is_in_bag || !parts_.stones.HasInside()) return;
  const auto organ = static_cast<std::size_t>(anatomy_.organ);
  const surgery::WallHole hole =
      parts_.wall.holes.FindLargest(tissue.organs[organ], tissue.state.position, parts_.organs[organ].Mesh());
  if (!(hole.rim > 0.0)) return;
  const int spilled = parts_.stones.Spill(leaked, leaked + tissue.conserved.organs[organ].target, hole);
  surgery::Fact fact = FactOf(FactKind::kStoneSpilled, -1);
  fact.surface = anatomy_.organ;
  for (int i = 0; i < spilled; ++i) Add(fact);
}

void Operation::MoveLoose(const HandsNow& hands, const OperatedTissue& tissue) noexcept {
  X_world_tools_ = hands.X_proxy;
  surgery::StoneGround ground;
  ground.organs = tissue.organs;
  ground.positions = tissue.state.position;
  ground.gravity = hands.gravity;
  ground.deepest = anatomy_.deepest;
  std::array<surgery::StonePusher, 2 * kHandCount> pushers;
  std::size_t count = 0;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const math::Pose& X = hands.X_proxy[static_cast<std::size_t>(hand)];
    const auto parts = instrument::CalcCapsules(Tool(hand), 0.0, kPushLength);
    pushers[count++] = {X * parts.shaft.a, X * parts.shaft.b, parts.shaft.radius};
    // jaws take stones between them; what has none pushes with its tip
    if (Tool(hand).max_jaw == 0.0 && !instrument::AbilitiesOf(Tool(hand).kind).is_bag)
      pushers[count++] = {X * parts.upper_jaw.a, X * parts.upper_jaw.b, parts.upper_jaw.radius};
  }
  ground.pushers = std::span(pushers).first(count);
  loose_clips_.clear();
  parts_.vessels->FindLooseClips(loose_clips_);
  parts_.stones.Move(ground, hands.X_proxy, loose_clips_, hands.seconds);
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (parts_.stones.HasTaken(hand)) Add(FactOf(FactKind::kStoneTaken, hand));
  }
}

void Operation::SlipClips(const HandsNow& hands, const OperatedTissue& tissue) noexcept {
  std::array<surgery::ClipPull, kHandCount> pulls;
  for (std::size_t hand = 0; hand < pulls.size(); ++hand)
    pulls[hand] = {tissue.grasps[hand].Nodes(), -hands.forces[hand]};
  std::array<surgery::SlippedClip, 4> slipped;
  const std::size_t count = parts_.vessels->Slip(hands.seconds, pulls, tissue.state.position, slipped);
  for (const surgery::SlippedClip& clip : std::span(slipped).first(count)) {
    AddOfTube(FactKind::kClipSlipped, -1, clip.place, clip.position);
  }
}

double Operation::StopJaw(int hand, double jaw_before, double jaw, bool is_holding) noexcept {
  const instrument::Tool& tool = Tool(hand);
  const bool can_take = !is_holding && instrument::AbilitiesOf(tool.kind).takes;
  return parts_.stones.StopJaw(hand, tool, X_world_tools_[static_cast<std::size_t>(hand)], jaw_before, jaw,
                               can_take);
}

void Operation::EmitRetrieved(int hand, int count) noexcept {
  for (int i = 0; i < count; ++i) Add(FactOf(FactKind::kStoneRetrieved, hand));
}

}  // namespace trocar::simulation
