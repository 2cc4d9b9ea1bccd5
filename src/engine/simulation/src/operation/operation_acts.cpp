// SPDX-License-Identifier: Apache-2.0
// Tools at work, and what their heat does.
#include <algorithm>
#include <cmath>

#include "operation/operation.h"

namespace trocar::simulation {

using math::Vec3;
using scene::HandControls;
using surgery::FactKind;

namespace {

constexpr double kOutOfTrocar = 0.035;   // a tool that is less deep has its tip in the trocar [m]
constexpr std::size_t kMostParted = 16;  // nodes that heat parts in a tick

}  // namespace

ToolUse Operation::UseOf(int hand, const HandsNow& hands, OperatedTissue& tissue) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  return {hand,
          Tool(hand),
          hands.X_proxy[h],
          hands.X_device[h],
          hands.joints[h].jaw,
          hands.joints[h].depth,
          hands.seconds,
          hands.input->controls[h],
          scene_->operation->parameters,
          *made_,
          anatomy_,
          tissue,
          parts_,
          *facts_};
}

void Operation::Act(const HandsNow& hands, OperatedTissue& tissue) noexcept {
  parts_.change.Clear();
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    HandState& state = hands_[static_cast<std::size_t>(hand)];
    state.electrode.has_current = false;
    state.suction = {};
    ToolUse use = UseOf(hand, hands, tissue);
    RefuseImpossible(use, state);
    const instrument::ToolAbilities& can = instrument::AbilitiesOf(use.tool.kind);
    if (can.spreads) Spread(use, state.spread);
    if (can.electrode != instrument::Electrode::kNone) UseElectrode(use, state.electrode);
    if (can.blade != instrument::Blade::kNone) UseBlade(use, state.blade);
    if (can.holds_clips) UseClips(use, state.clips);
    if (can.staples) UseStapler(use, state.clips, state.blade.fronts);
    if (can.sucks) UseSuction(use, state.suction);
    if (can.is_bag) UseBag(use, assistant_ ? &assistant_->Held() : nullptr);
  }
}

/// Answers what cannot be done, once each time that it is tried.
void Operation::RefuseImpossible(ToolUse& use, HandState& state) noexcept {
  const HandControls& controls = use.controls;
  const instrument::Tool& tool = use.tool;
  const instrument::ToolAbilities& can = instrument::AbilitiesOf(tool.kind);
  const bool has_bitten = can.bites && state.was_open && use.jaw <= kBitten * tool.max_jaw;
  if (use.jaw > kOpenAgain * tool.max_jaw) state.was_open = true;
  if (has_bitten) state.was_open = false;
  const bool is_used =
      has_bitten || controls.cut || controls.coagulate || controls.rinse || controls.aspirate;
  const bool is_outside = use.depth < kOutOfTrocar;
  if (is_used && is_outside && !state.was_outside_emitted)
    use.facts.Add(use.MakeFact(FactKind::kUsedOutside));
  state.was_outside_emitted = is_outside && (is_used || state.was_outside_emitted);
  if (has_bitten && !is_outside && (can.holds_clips || can.staples) && state.clips.clips == 0 &&
      !state.clips.has_clip_open)
    use.facts.Add(use.MakeFact(FactKind::kNoClipsLeft));
}

void Operation::Heat(const HandsNow& hands, OperatedTissue& tissue) noexcept {
  std::array<std::uint32_t, kMostParted> parted;
  const std::size_t count = parts_.heat.Step(hands.seconds, tissue.state, parted);
  parts_.smoke += Electrode().smoke_by_heat * parts_.heat.Power() * hands.seconds;
  std::int32_t hand = -1;
  for (int i = 0; i < instrument::kHandCount; ++i) {
    if (hands_[static_cast<std::size_t>(i)].electrode.has_current) hand = i;
  }
  for (const std::uint32_t node : std::span(parted).first(count)) {
    surgery::Fact fact = FactOf(FactKind::kOrganBurnt, hand);
    fact.position = tissue.state.position[node];
    surgery::TubePlace place;
    if (IsOf(node, anatomy_.organ)) {
      tissue.conservation.Perforate(static_cast<std::size_t>(anatomy_.organ), Electrode().burnt_hole,
                                    tissue.conserved);
      parts_.wall.holes.Add(node, Electrode().burnt_rim);
      fact.surface = anatomy_.organ;
      Add(fact);
    } else if (IsOf(node, anatomy_.host)) {
      fact.surface = anatomy_.host;
      Add(fact);
    } else if (parts_.vessels->MakeHole(node, Electrode().burnt_hole, place)) {
      AddOfTube(FactKind::kTubeBurnt, hand, place, fact.position);
    }
  }
  OpenTubeEnds(tissue);
}

/// A duct or artery that was burnt or torn off the organ is open there, as one that was cut.
void Operation::OpenTubeEnds(const OperatedTissue& tissue) noexcept {
  if (parts_.retrieval.is_in_bag) return;
  for (TubeEnd& end : tube_ends_) {
    if (end.is_off || std::any_of(end.strands.begin(), end.strands.end(),
                                  [&](std::uint32_t i) { return tissue.state.strand_is_intact[i] != 0; }))
      continue;
    end.is_off = true;
    surgery::TubePlace place;
    if (parts_.vessels->MakeHole(end.node, end.section, place))
      AddOfTube(FactKind::kTubeTornOff, -1, place, tissue.state.position[end.node]);
  }
}

}  // namespace trocar::simulation
