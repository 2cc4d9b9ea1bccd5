// SPDX-License-Identifier: Apache-2.0
// What each tool does to tissue.
#include <algorithm>
#include <cmath>

#include "operation/operation.h"
#include "trocar/geometry/openings.h"
#include "trocar/math/elementary.h"

namespace trocar::simulation {

using math::Pose;
using math::Vec3;
using scene::HandControls;
using surgery::FactKind;

namespace {

// Clip applier: closed and open again, as shares of its opening
constexpr double kClipClosed = 0.12, kClipOpen = 0.6;

constexpr double kOutOfTrocar = 0.035;  // a tool that is less deep has its tip in the trocar [m]

constexpr double kMouth = 0.030;  // of the bag: what lies within of its tip is in it [m]
constexpr double kBagGrip = 1e4;  // nothing slips out of a closed bag [N]

/// A jaw as an edge, hinge to tip.
geometry::BladeEdge JawEdge(const instrument::Tool& tool, const Pose& X_world_tool, double jaw, int side) {
  return {X_world_tool * instrument::JawHinge(tool), X_world_tool * instrument::JawTip(tool, jaw, side)};
}

// most of each in a tick
constexpr std::size_t kMostStrandsCut = 64, kMostStrandsSpread = 16, kMostHeated = 96, kMostParted = 16;
// a hand heats and spreads, or heats and cuts; the rest is for organs, stones, clips and what jaws hold
static_assert(surgery::FactList::kCapacity >= instrument::kHandCount * (kMostHeated + 2 * kMostStrandsSpread +
                                                                        surgery::CuttableTubes::kMostCuts) +
                                                  kMostParted + 32);

}  // namespace

void Operation::AddOfStrand(FactKind kind, int hand, std::uint32_t strand, const TissueNow& tissue) noexcept {
  surgery::Fact fact = FactOf(kind, hand);
  fact.strand = static_cast<std::int32_t>(strand);
  fact.position = tissue.state->position[strands_[strand].a];
  Add(fact);
}

void Operation::UseBlade(int hand, const HandsNow& hands, const TissueNow& tissue,
                         OperatedTissue& operated) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const bool is_hook = Tool(hand).kind == instrument::ToolKind::kHook;
  surgery::BladeSettings settings;
  settings.kind = is_hook ? surgery::BladeKind::kHook : surgery::BladeKind::kScissors;
  // the hook that is seen never enters tissue: it cuts where the hand presses it
  const Pose& X = is_hook ? hands.X_device[h] : hands.X_proxy[h];
  const auto move = surgery::MoveBlade(Tool(hand), X, hands.joints[h].jaw, hands.input->controls[h].cut,
                                       settings, hands_[h].blade);
  if (!move) {
    for (geometry::CutFront& front : hands_[h].fronts) front = {};
    return;
  }
  CutWith(*move, hand, hands, tissue, operated, !is_hook);
}

void Operation::CutWith(const surgery::BladeMove& move, int hand, const HandsNow& hands,
                        const TissueNow& tissue, OperatedTissue& operated, bool cuts_strands) noexcept {
  if (cuts_strands) CutStrands(move, hand, tissue, operated);
  std::array<surgery::TubePlace, surgery::CuttableTubes::kMostCuts> places;
  const std::size_t tubes = vessels_->Cut(move, *tissue.definition, tissue.state->position, change_, places);
  for (const surgery::TubePlace& place : std::span(places).first(tubes))
    AddOfTube(FactKind::kTubeCut, hand, place, hands.X_proxy[static_cast<std::size_t>(hand)].translation);
  CutOrgans(move, hand, hands, tissue, operated);
}

void Operation::CutStrands(const surgery::BladeMove& move, int hand, const TissueNow& tissue,
                           OperatedTissue& operated) noexcept {
  std::array<std::uint32_t, kMostStrandsCut> cut;
  const std::size_t count = surgery::FindCutStrands(move, tissue.definition->strands, *tissue.state, cut);
  for (const std::uint32_t strand : std::span(cut).first(count)) {
    operated.state.strand_is_intact[strand] = 0;
    AddOfStrand(FactKind::kStrandCut, hand, strand, tissue);
  }
}

void Operation::CutOrgans(const surgery::BladeMove& move, int hand, const HandsNow& hands,
                          const TissueNow& tissue, OperatedTissue& operated) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const geometry::CutReport report =
        organs_[i].Cut(move.before, move.now, tissue.state->position, hands_[h].fronts[i], change_);
    if (!report.HasChanged()) continue;
    surgery::Fact fact = FactOf(FactKind::kOrganCut, hand);
    fact.surface = static_cast<std::int32_t>(i);
    fact.position = hands.X_proxy[h].translation;
    Add(fact);
    if (fact.surface != anatomy_.gallbladder) continue;
    std::array<geometry::Opening, 8> openings;
    const std::size_t found = std::min(openings.size(), geometry::FindOpenings(organs_[i].Mesh(), openings));
    double area = 0;
    for (std::size_t k = 0; k < found; ++k) area += openings[k].area;
    if (found == 0) continue;
    fact.kind = FactKind::kOrganOpened;
    fact.amount = area;
    Add(fact);
    tissue.conservation->Perforate(i, std::max(Electrode().burnt_hole, area - wall_.open_area),
                                   operated.conserved);
    wall_.open_area = std::max(area, wall_.open_area);
  }
}

void Operation::Spread(int hand, const HandsNow& hands, const TissueNow& tissue,
                       OperatedTissue& operated) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  HandState& state = hands_[h];
  const double jaw = hands.joints[h].jaw;
  const bool opens = jaw > state.spread_upper.jaw;
  state.spread_upper.jaw = jaw;
  const auto edges = std::array{JawEdge(Tool(hand), hands.X_proxy[h], jaw, +1),
                                JawEdge(Tool(hand), hands.X_proxy[h], jaw, -1)};
  auto& upper = state.spread_upper.edge;
  auto& lower = state.spread_lower.edge;
  if (opens && upper && lower) {
    // what a jaw pushes before it as it opens gives way, fibre by fibre
    for (const auto& move : {surgery::BladeMove{*upper, edges[0]}, surgery::BladeMove{*lower, edges[1]}}) {
      std::array<std::uint32_t, kMostStrandsSpread> torn;
      const std::size_t count =
          surgery::FindCutStrands(move, tissue.definition->strands, *tissue.state, torn);
      for (std::size_t i = 0; i < count; ++i) {
        const scene::StrandInfo::Kind kind = strands_[torn[i]].kind;
        if (kind == scene::StrandInfo::Kind::kEnd) continue;  // a duct's end does not give way to a jaw
        operated.state.strand_is_intact[torn[i]] = 0;
        AddOfStrand(FactKind::kStrandSpread, hand, torn[i], tissue);
      }
    }
  }
  upper = edges[0];
  lower = edges[1];
}

void Operation::UseElectrode(int hand, const HandsNow& hands, const TissueNow& tissue) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const HandControls& controls = hands.input->controls[h];
  if (!controls.cut && !controls.coagulate) {
    hands_[h].idle_seconds = 0;
    return;
  }
  const instrument::Tool& tool = Tool(hand);
  const Pose& X = hands.X_proxy[h];
  surgery::Electrosurgery::Electrode electrode;
  if (tool.kind == instrument::ToolKind::kHook) {
    const surgery::BladeSettings blade;
    electrode.bare = {X * blade.p_tool_hook.a, X * blade.p_tool_hook.b};
  } else {
    electrode.bare = {X.translation, X * Vec3{0, 0, 0.25 * tool.jaw_length}};
  }
  const scene::CurrentParameters& current = controls.cut ? Electrode().cut : Electrode().coagulate;
  electrode.power = current.power;
  electrode.reach = current.reach;
  std::array<surgery::Electrosurgery::Target, kMostHeated> targets;
  const std::size_t count =
      heat_.FindTargets(electrode, tissue.organs, *tissue.tubes, *tissue.state, targets);
  double& idle = hands_[h].idle_seconds;
  idle = count == 0 ? idle + hands.seconds : 0.0;
  surgery::Fact fact = FactOf(FactKind::kCurrentOn, hand);
  fact.is_coagulating = !controls.cut;
  fact.amount = idle;
  fact.position = X.translation;
  Add(fact);
  if (count == 0) return;
  hands_[h].has_current = true;
  heat_.AddPower(electrode, std::span(targets).first(count));
  if (controls.coagulate)
    vessels_->Seal(X.translation, Electrode().seal_reach,
                   electrode.power * hands.seconds / Electrode().seal_heat, tissue.state->position);
  fact.kind = FactKind::kCurrentInto;
  fact.amount = 0;
  const std::size_t nodes = tissue.definition->rest.size();
  for (const surgery::Electrosurgery::Target& target : std::span(targets).first(count)) {
    const bool is_strand = target.part >= nodes;
    fact.strand = is_strand ? static_cast<std::int32_t>(target.part - nodes) : -1;
    fact.surface = is_strand ? -1 : SurfaceOf(target.part);
    Add(fact);
  }
}

void Operation::Heat(const HandsNow& hands, const TissueNow& tissue, OperatedTissue& operated) noexcept {
  std::array<std::uint32_t, kMostParted> parted;
  const std::size_t count = heat_.Step(hands.seconds, operated.state, parted);
  smoke_ += Electrode().smoke_by_heat * heat_.Power() * hands.seconds;
  std::int32_t hand = -1;
  for (int i = 0; i < instrument::kHandCount; ++i) {
    if (hands_[static_cast<std::size_t>(i)].has_current) hand = i;
  }
  for (const std::uint32_t node : std::span(parted).first(count)) {
    surgery::Fact fact = FactOf(FactKind::kOrganBurnt, hand);
    fact.position = tissue.state->position[node];
    surgery::TubePlace place;
    if (IsOf(node, anatomy_.gallbladder)) {
      tissue.conservation->Perforate(static_cast<std::size_t>(anatomy_.gallbladder), Electrode().burnt_hole,
                                     operated.conserved);
      wall_.holes.Add(node, Electrode().burnt_rim);
      fact.surface = anatomy_.gallbladder;
      Add(fact);
    } else if (IsOf(node, anatomy_.liver)) {
      fact.surface = anatomy_.liver;
      Add(fact);
    } else if (vessels_->MakeHole(node, Electrode().burnt_hole, place)) {
      AddOfTube(FactKind::kTubeBurnt, hand, place, fact.position);
    }
  }
  OpenTubeEnds(tissue);
}

/// A duct or artery that was burnt or torn off the gallbladder is open there, as one that was cut.
void Operation::OpenTubeEnds(const TissueNow& tissue) noexcept {
  if (retrieval_.is_in_bag) return;
  for (TubeEnd& end : tube_ends_) {
    if (end.is_off || std::any_of(end.strands.begin(), end.strands.end(),
                                  [&](std::uint32_t i) { return tissue.state->strand_is_intact[i] != 0; }))
      continue;
    end.is_off = true;
    surgery::TubePlace place;
    if (vessels_->MakeHole(end.node, end.section, place))
      AddOfTube(FactKind::kTubeTornOff, -1, place, tissue.state->position[end.node]);
  }
}

void Operation::UseClips(int hand, const HandsNow& hands, const TissueNow& tissue) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  HandState& state = hands_[h];
  const instrument::Tool& tool = Tool(hand);
  const double jaw = hands.joints[h].jaw;
  if (jaw > kClipOpen * tool.max_jaw) {
    state.has_clip_open = state.clips > 0;
    // as long as they open, or rest; what lies there when they close is caught
    if (jaw >= state.opened || !state.caught) {
      state.opened = jaw;
      state.caught = vessels_->Catch(tool, hands.X_proxy[h], jaw, tissue.state->position);
    }
  }
  if (!state.has_clip_open || jaw > kClipClosed * tool.max_jaw) return;
  state.has_clip_open = false;
  --state.clips;
  const surgery::ClipResult clip =
      vessels_->Clip(tool, hands.X_proxy[h], state.caught, tissue.state->position);
  state.caught.reset();
  state.opened = 0;
  surgery::Fact fact = FactOf(FactKind::kClipClosed, hand);
  fact.position = hands.X_proxy[h].translation;
  fact.is_crossed = clip.is_crossed;
  fact.is_partial = clip.kind == surgery::ClipResult::Kind::kPartial;
  if (clip.kind == surgery::ClipResult::Kind::kLost) {
    fact.kind = FactKind::kClipLost;
  } else {
    fact.surface = static_cast<std::int32_t>(organs_.size() + clip.place.tube);
    fact.along = clip.place.arc;
    fact.p_rest = vessels_->RestPoint(clip.place);
  }
  Add(fact);
}

/// Answers what cannot be done, once each time that it is tried.
void Operation::RefuseImpossible(int hand, const HandsNow& hands) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  HandState& state = hands_[h];
  const HandControls& controls = hands.input->controls[h];
  const instrument::Tool& tool = Tool(hand);
  const bool bites =
      tool.kind == instrument::ToolKind::kScissors || tool.kind == instrument::ToolKind::kClipApplier;
  const double jaw = hands.joints[h].jaw;
  const bool has_bitten = bites && state.was_open && jaw <= kClipClosed * tool.max_jaw;
  if (jaw > kClipOpen * tool.max_jaw) state.was_open = true;
  if (has_bitten) state.was_open = false;
  const bool is_used =
      has_bitten || controls.cut || controls.coagulate || controls.rinse || controls.aspirate;
  const bool is_outside = hands.joints[h].depth < kOutOfTrocar;
  if (is_used && is_outside && !state.was_outside_emitted) Add(FactOf(FactKind::kUsedOutside, hand));
  state.was_outside_emitted = is_outside && (is_used || state.was_outside_emitted);
  if (has_bitten && !is_outside && tool.kind == instrument::ToolKind::kClipApplier && state.clips == 0 &&
      !state.has_clip_open)
    Add(FactOf(FactKind::kNoClipsLeft, hand));
}

void Operation::UseFluids(int hand, const HandsNow& hands) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const HandControls& controls = hands.input->controls[h];
  hands_[h].is_rinsing = controls.rinse;
  hands_[h].is_aspirating = controls.aspirate;
  surgery::Fact fact = FactOf(FactKind::kRinse, hand);
  fact.position = hands.X_proxy[h].translation;
  if (controls.rinse) {
    fact.amount = Suction().rinse_rate * hands.seconds;
    fluids_.Rinse(fact.amount);
    Add(fact);
  }
  if (!controls.aspirate) return;
  smoke_ *= std::max(0.0, 1.0 - Suction().smoke_rate * hands.seconds);
  EmitRetrieved(hand, stones_.Aspirate(hands.X_proxy[h].translation,
                                       2.0 * instrument::kSuctionBore * Tool(hand).shaft_radius));
  // the pool as a half sphere
  const double radius = math::Cbrt(fluids_.Pooled() * 3.0 / (2.0 * M_PI));
  if (math::Distance(hands.X_proxy[h].translation, anatomy_.p_pool) > radius + Suction().pool_reach) return;
  fact.kind = FactKind::kAspirate;
  fact.amount = fluids_.Aspirate(Suction().aspirate_rate * hands.seconds);
  if (fact.amount > 0.0) Add(fact);
}

void Operation::UseBag(int hand, const HandsNow& hands, const TissueNow& tissue,
                       OperatedTissue& operated) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  Add(FactOf(FactKind::kBagOpen, hand));
  if (!retrieval_.is_in_bag) EmitRetrieved(hand, stones_.CatchInBag(hands.X_device[h]));
  if (retrieval_.is_in_bag || anatomy_.gallbladder < 0 || !retrieval_.is_gallbladder_free) return;
  const scene::SurfaceInfo& surface = made_->surfaces[static_cast<std::size_t>(anatomy_.gallbladder)];
  Vec3 centre;
  for (std::uint32_t i = 0; i < surface.node_count; ++i)
    centre += tissue.state->position[surface.first_node + i] / static_cast<double>(surface.node_count);
  const Pose& X = hands.X_device[h];
  if (math::Distance(centre, X.translation) > kMouth) return;
  // the other hands let go, and the bag closes around it
  for (surgery::Grasp& grasp : operated.grasps) {
    if (grasp.surface == anatomy_.gallbladder) surgery::ReleaseGrasp(*tissue.model, grasp, operated.state);
  }
  if (assistant_) surgery::ReleaseGrasp(*tissue.model, assistant_->Held(), operated.state);
  surgery::Grasp& held = operated.grasps[h];
  held = {};
  held.surface = anatomy_.gallbladder;
  held.pinch = held.damage_pinch = kBagGrip;
  const auto capacity = static_cast<std::uint32_t>(surgery::Grasp::kCapacity);
  const std::uint32_t step = std::max(1U, surface.node_count / capacity);
  const Pose X_tool_world = math::Inverse(X);
  for (std::uint32_t i = 0; i < surface.node_count && held.count < surgery::Grasp::kCapacity; i += step) {
    const std::uint32_t node = surface.first_node + i;
    held.nodes[held.count] = node;
    held.p_tool_node[held.count++] = X_tool_world * tissue.state->position[node];
    operated.state.condition[node] = tissue::NodeCondition::kPrescribed;
  }
  EmitRetrieved(hand, stones_.BagWith(anatomy_.gallbladder));
  retrieval_.is_in_bag = true;
  retrieval_.bag_hand = hand;
}

}  // namespace trocar::simulation
