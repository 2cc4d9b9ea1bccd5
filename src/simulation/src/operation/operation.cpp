// SPDX-License-Identifier: Apache-2.0
#include "operation/operation.h"

#include <algorithm>
#include <cmath>

#include "operation/gallbladder_anatomy.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"
#include "trocar/scene/pathology.h"
#include "trocar/scene/patient_vessels.h"

namespace trocar::simulation {

using scene::CalcPathology;
using scene::kLeft;
using scene::kRight;
namespace {

/// A tool that is exchanged is out of the way at this depth [m], for this long [s].
constexpr double kOutside = 0.031, kExchangeSeconds = 0.5;
constexpr double kMainDistance = 0.010;  // fibres nearer to what must stay are left alone [m]
/// Where blood and bile gather, seen from the infundibulum: to the right and behind, in Morison's pouch [m].
constexpr Vec3 kPouch{-0.015, 0.0, -0.025};
constexpr double kBelowAll = -0.03;  // under the lowest organ: what falls beside everything stops there [m]

training::PatternCutMonitor MakePatternCutMonitor(const scene::ModelSheet& sheet,
                                                  const geometry::EditableMesh& mesh) {
  return {{sheet.centre, sheet.half, sheet.circle}, mesh};
}

}  // namespace

core::Result<std::unique_ptr<Operation>> Operation::Make(const Scene& scene,
                                                         std::shared_ptr<const PatientTissue> tissue) {
  std::unique_ptr<Operation> made(new Operation(scene, tissue->strands));
  auto stones = MakeGallstones(scene, tissue->surfaces, tissue->definition.rest);
  made->made_ = std::move(tissue);
  if (!stones.ok()) return stones.error();
  made->stones_ = std::move(*stones);
  made->loose_clips_.reserve(surgery::VesselActs::kMostClips);
  if (const auto status = made->MakeAll(); !status.ok()) return status.error();
  return made;
}

core::Status Operation::MakeAll() {
  const anatomy::Patient& patient = scene_->patient;
  const PatientTissue& tissue = *made_;
  liver_ = scene::FindSurface(tissue.surfaces, roles::OrganRole::kLiver);
  gallbladder_ = scene::FindSurface(tissue.surfaces, roles::OrganRole::kGallbladder);
  const std::size_t organ_count = patient.organs.size();
  organs_.clear();
  for (std::size_t i = 0; i < organ_count; ++i) {
    surgery::CuttableOrganSettings settings;
    settings.wall = tissue.walls[i];
    settings.cut.has_walls = static_cast<std::int32_t>(i) != gallbladder_ && !scene_->model;
    settings.first_node = tissue.surfaces[i].first_node;
    settings.first_spare = tissue.first_spare[i];
    settings.spare_count = kSpare.by_organ;
    auto organ = surgery::CuttableOrgan::Make(patient.organs[i].mesh, settings);
    if (!organ.ok()) return organ.error();
    organ->ReserveFor(change_);
    organs_.push_back(std::move(*organ));
  }
  sheets_.clear();
  for (std::size_t i = 0; scene_->model && i < scene_->model->sheets.size(); ++i)
    sheets_.push_back(MakePatternCutMonitor(scene_->model->sheets[i], organs_[i].Mesh()));
  const scene::OperationParameters& parameters = scene_->operation->parameters;
  auto vessels = scene::MakePatientVessels(patient, parameters.supplies, parameters.fluids);
  if (!vessels.ok()) return vessels.error();
  biliary_ = std::move(vessels->anatomy);
  vessels_ = MakeVessels(std::move(vessels->map), patient, tissue, kSpare.tubes, parameters.vessels);
  vessels_->ReserveFor(change_);
  change_.Clear();

  main_nodes_.clear();
  main_ducts_.clear();
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = tissue.surfaces[organ_count + t];
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      const surgery::VesselPlace place = vessels_->Map().Find(t, vessels_->Map().arcs[t][k]);
      if (training::MayBeDivided(biliary_.roles[place.vessel])) continue;
      main_nodes_.push_back(surface.first_node + k);
      if (patient.tubes[t].kind == anatomy::TubeKind::kDuct) main_ducts_.push_back(surface.first_node + k);
    }
  }
  tube_ends_.clear();
  for (surgery::EnteringTube& tube : FindEnteringTubes(patient, tissue.surfaces, strands_)) {
    const SurfaceInfo& surface = tissue.surfaces[organ_count + tube.tube];
    const double radius = surface.radii[tube.nodes.front() - surface.first_node];
    TubeEnd end{tube.nodes.front(), std::move(tube.end_strands), M_PI * radius * radius};
    if (!end.strands.empty()) tube_ends_.push_back(std::move(end));
  }
  // what lies around ducts that must stay is none of the dissection's business
  dissected_ = strands_;
  for (StrandInfo& strand : dissected_) {
    if (strand.kind != StrandInfo::Kind::kTriangle && strand.kind != StrandInfo::Kind::kPeritoneum) continue;
    const Vec3 middle = 0.5 * (tissue.definition.rest[strand.a] + tissue.definition.rest[strand.b]);
    const bool is_near = std::any_of(main_nodes_.begin(), main_nodes_.end(), [&](std::uint32_t node) {
      return math::Distance(tissue.definition.rest[node], middle) < kMainDistance;
    });
    if (is_near) strand.kind = StrandInfo::Kind::kEnd;
  }
  heat_ = surgery::Electrosurgery(tissue.definition, tissue.heat_mass, parameters.heat);
  attachment_ = MakeAttachment(patient, tissue.surfaces, dissected_);
  assistant_.reset();
  if (scene_->operation->assistant) {
    const AssistantSetup& setup = *scene_->operation->assistant;
    const Vec3& target = setup.p_world_target;
    assistant_.emplace(setup, target);
    // the landmark moves with the organ: the nearest vertex at rest carries it
    const SurfaceInfo& surface = tissue.surfaces[static_cast<std::size_t>(std::max(0, gallbladder_))];
    const auto& rest = tissue.definition.rest;
    assistant_node_ = surface.first_node;
    for (std::uint32_t node = surface.first_node; node < surface.first_node + surface.node_count; ++node) {
      if (math::SquaredDistance(rest[node], target) < math::SquaredDistance(rest[assistant_node_], target))
        assistant_node_ = node;
    }
  }
  const anatomy::Landmark* neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  p_pool_ = (neck != nullptr ? neck->position : Vec3{}) + kPouch;
  fluids_ = {};
  holes_ = {};
  stones_.Reset();
  MakeOoze();
  deepest_ = kBelowAll;
  for (const Vec3& p : tissue.definition.rest) deepest_ = std::min(deepest_, p.z + kBelowAll);
  X_world_tools_ = {};
  active_ = {};
  for (int hand = 0; hand < kHandCount; ++hand) {
    HandState& state = hands_[static_cast<std::size_t>(hand)];
    state = {};
    state.fronts.resize(organ_count);
    state.blade.jaw = state.spread_upper.jaw = scene_->instruments[hand].home.jaw;
    state.clips = Tool(hand).clips;
  }
  leaked_seen_ = open_area_ = smoke_ = 0;
  topology_version_ = 0;
  is_in_bag_ = is_completed_ = is_gallbladder_free_ = false;
  bag_hand_ = -1;
  BeginTick();
  band_strands_.clear();
  band_starts_.assign(1, 0);
  for (std::size_t band = 0; scene_->model && band < scene_->model->bands.size(); ++band) {
    for (std::uint32_t i = 0; i < strands_.size(); ++i) {
      if (strands_[i].band == static_cast<std::int32_t>(band)) band_strands_.push_back(i);
    }
    band_starts_.push_back(static_cast<std::uint32_t>(band_strands_.size()));
  }
  return {};
}

/// What bleeds where the gallbladder comes off the liver.
void Operation::MakeOoze() {
  std::vector<surgery::LiverFibre> fibres;
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    const StrandInfo& strand = strands_[i];
    const bool is_bed = strand.kind == StrandInfo::Kind::kBed;
    if (!is_bed && strand.kind != StrandInfo::Kind::kAdhesion) continue;
    const bool is_b = IsOf(strand.b, liver_);
    if (is_b || IsOf(strand.a, liver_)) fibres.push_back({i, is_b ? strand.b : strand.a, is_bed});
  }
  ooze_ = surgery::BedOoze(fibres, CalcPathology(scene_->patient).bed_bleeding,
                           scene_->operation->parameters.bed);
}

void Operation::Emit(const OperationEvent& event) noexcept {
  if (event_count_ < events_.size()) events_[event_count_++] = event;
}

bool Operation::IsOf(std::uint32_t node, std::int32_t organ) const noexcept {
  if (organ < 0) return false;
  const auto i = static_cast<std::size_t>(organ);
  const std::uint32_t first = made_->surfaces[i].first_node;
  return node >= first && node < made_->first_spare[i] + kSpare.by_organ;
}

// --- tools

bool Operation::MoveTool(int hand, const HandControls& controls, bool is_holding, double seconds,
                         instrument::TrocarJoints& wanted) noexcept {
  HandState& state = hands_[static_cast<std::size_t>(hand)];
  std::size_t& active = active_[static_cast<std::size_t>(hand)];
  const bool wants_other = controls.tool != active && controls.tool < scene_->instruments[hand].tray.size();
  // a stone goes out with the tool that holds it, where the trocar is wide enough
  const bool is_stuck = HoldsStone(hand) && stones_.HeldDiameter(hand) > WidestTool(hand);
  const bool may = (!is_holding && !is_stuck) || bag_hand_ == hand;
  if (!wants_other || !may) {
    const bool is_refused = wants_other && !state.was_refused;
    state.was_refused = wants_other;
    state.exchange_seconds = 0;
    return !is_refused;
  }
  state.was_refused = false;
  wanted.depth = kOutside;
  wanted.jaw = 0;
  state.exchange_seconds += seconds;
  if (state.exchange_seconds < kExchangeSeconds) return true;
  if (bag_hand_ == hand) {
    is_completed_ = is_in_bag_;
    return true;
  }
  EmitRetrieved(hand, stones_.TakeOut(hand));
  active = controls.tool;
  state.exchange_seconds = 0;
  state.blade = {};
  state.spread_upper = state.spread_lower = {};
  state.clips = Tool(hand).clips;
  state.has_clip_open = state.was_open = false;
  acts_.SetExchanged(hand);
  return true;
}

/// Diameter of what passes a hand's trocar: of its widest tool [m].
double Operation::WidestTool(int hand) const noexcept {
  double widest = 0;
  for (const instrument::Tool& tool : scene_->instruments[hand].tray)
    widest = std::max(widest, 2.0 * tool.shaft_radius);
  return widest;
}

void Operation::BeginTick() noexcept {
  event_count_ = 0;
  acts_.Clear();
}

void Operation::Act(const HandsNow& hands, const TissueNow& tissue, OperatedTissue& operated) noexcept {
  change_.Clear();
  for (int hand = 0; hand < kHandCount; ++hand) {
    hands_[static_cast<std::size_t>(hand)].has_current = false;
    RefuseImpossible(hand, hands);
    switch (Tool(hand).kind) {
      case instrument::ToolKind::kScissors:
        UseBlade(hand, hands, tissue, operated);
        break;
      case instrument::ToolKind::kHook:
        UseElectrode(hand, hands, tissue);
        UseBlade(hand, hands, tissue, operated);
        break;
      case instrument::ToolKind::kDissector:
        Spread(hand, hands, tissue, operated);
        UseElectrode(hand, hands, tissue);
        break;
      case instrument::ToolKind::kClipApplier:
        UseClips(hand, hands, tissue);
        break;
      case instrument::ToolKind::kSuctionIrrigator:
        UseFluids(hand, hands);
        break;
      case instrument::ToolKind::kBag:
        UseBag(hand, hands, tissue, operated);
        break;
      case instrument::ToolKind::kGrasper:
        break;
    }
  }
}

void Operation::Assist(const HandsNow& hands, const TissueNow& tissue, OperatedTissue& operated) noexcept {
  if (!assistant_) return;
  const AssistantCommand command = is_in_bag_ ? AssistantCommand::kRelease : hands.input->assistant;
  (void)assistant_->Step(command, tissue.state->position[assistant_node_], hands.seconds, tissue.organs,
                         *tissue.model, {}, operated.state);
}

bool Operation::EndCuts() noexcept {
  if (change_.nodes.empty() && change_.springs.empty()) return false;
  for (const surgery::NodeChange& node : change_.nodes) {
    if (node.is_new && node.from[0] != geometry::kNone) heat_.CopyNode(node.from[0], node.node);
  }
  for (std::size_t i = 0; i < sheets_.size(); ++i) sheets_[i].Update(organs_[i].Mesh());
  ++topology_version_;
  stones_.ForgetSupports();
  return true;
}

training::Target Operation::TargetOfSurface(std::int32_t surface) const noexcept {
  using training::Target;
  if (surface < 0) return Target::kNullTarget;
  if (surface == liver_) return Target::kLiver;
  if (surface == gallbladder_) return Target::kGallbladder;
  const roles::TubeRole tube = made_->surfaces[static_cast<std::size_t>(surface)].tube;
  if (tube == roles::TubeRole::kCysticDuct) return Target::kCysticDuct;
  return tube == roles::TubeRole::kCysticArtery ? Target::kCysticArtery : Target::kBloodVessel;
}

training::Target Operation::TargetOf(const TissueNow& tissue, std::uint32_t part) const noexcept {
  using training::Target;
  const std::size_t nodes = tissue.definition->rest.size();
  if (part >= nodes) {
    switch (strands_[part - nodes].kind) {
      case StrandInfo::Kind::kBed:
        return Target::kCysticPlate;
      case StrandInfo::Kind::kAdhesion:
        return Target::kAdhesion;
      case StrandInfo::Kind::kPeritoneum:
        return Target::kPeritoneum;
      case StrandInfo::Kind::kTriangle:
      case StrandInfo::Kind::kEnd:
      case StrandInfo::Kind::kBand:
        return Target::kCysticPedicle;
    }
  }
  for (std::size_t i = 0; i < made_->surfaces.size(); ++i) {
    const SurfaceInfo& surface = made_->surfaces[i];
    if (part >= surface.first_node && part < surface.first_node + surface.node_count)
      return TargetOfSurface(static_cast<std::int32_t>(i));
  }
  return Target::kNullTarget;
}

// --- what others see

std::vector<collision::TubePiece> Operation::TubePieces() const {
  std::vector<collision::TubePiece> pieces;
  const auto& graph = vessels_->Tubes().Graph();
  for (const geometry::Edge& edge : graph.edges)
    pieces.push_back({vessels_->Tubes().Node(edge[0]), vessels_->Tubes().Node(edge[1]),
                      std::max(graph.radii[edge[0]], graph.radii[edge[1]])});
  return pieces;
}

std::vector<std::uint32_t> Operation::TubesOfPieces() const {
  std::vector<std::uint32_t> tubes;
  for (const geometry::Edge& edge : vessels_->Tubes().Graph().edges)
    tubes.push_back(vessels_->TubeOf(edge[0]));
  return tubes;
}

void Operation::Size(OperationSnapshot& snapshot) const {
  const std::size_t nodes = made_->definition.rest.size();
  snapshot.strand_is_intact.assign(strands_.size(), 1);
  snapshot.blanching.assign(nodes, 0.0F);
  snapshot.charring.assign(nodes, 0.0F);
  snapshot.clips.assign(surgery::VesselActs::kMostClips, {});
  snapshot.band_is_whole.assign(band_starts_.size() - 1, 1);
  snapshot.sheets.assign(sheets_.size(), {});
  snapshot.stones.assign(stones_.Size(), {});
  snapshot.tube_pieces.assign(vessels_->Tubes().Graph().edges.size() + kSpare.tubes / 2, {});
  std::size_t triangles = 0;
  snapshot.first_triangle.clear();
  for (const surgery::CuttableOrgan& organ : organs_) {
    snapshot.first_triangle.push_back(static_cast<std::uint32_t>(triangles));
    triangles += organ.Mesh().TriangleCapacity();
  }
  snapshot.triangles.assign(triangles, {});
  snapshot.triangle_count.assign(organs_.size(), 0);
  snapshot.topology_version = std::numeric_limits<std::uint32_t>::max();
}

void Operation::Publish(const tissue::TissueState& tissue, OperationSnapshot& snapshot) const noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    snapshot.tools[h] = static_cast<std::uint8_t>(active_[h]);
    snapshot.has_current[h] = hands_[h].has_current;
    snapshot.clips_left[h] = hands_[h].clips;
  }
  std::copy(tissue.strand_is_intact.begin(), tissue.strand_is_intact.end(),
            snapshot.strand_is_intact.begin());
  for (std::size_t i = 0; i < sheets_.size(); ++i) snapshot.sheets[i] = sheets_[i].Now();
  for (std::size_t band = 0; band < snapshot.band_is_whole.size(); ++band) {
    const auto own =
        std::span(band_strands_).subspan(band_starts_[band], band_starts_[band + 1] - band_starts_[band]);
    snapshot.band_is_whole[band] =
        std::all_of(own.begin(), own.end(), [&](std::uint32_t i) { return tissue.strand_is_intact[i] != 0; });
  }
  heat_.Publish(snapshot.blanching, snapshot.charring);
  if (snapshot.topology_version != topology_version_) {
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      const surgery::CuttableOrgan& organ = organs_[i];
      const auto triangles = organ.Mesh().Triangles();
      snapshot.triangle_count[i] = static_cast<std::uint32_t>(triangles.size());
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
          snapshot.triangles[snapshot.first_triangle[i] + t][k] = organ.Node(triangles[t][k]);
      }
    }
    snapshot.topology_version = topology_version_;
  }
  snapshot.tube_piece_count = vessels_->PublishPieces(organs_.size(), snapshot.tube_pieces);
  snapshot.clip_count = vessels_->PublishClips(tissue.position, snapshot.clips);
  snapshot.tube_cut_count = vessels_->PublishCuts(snapshot.tube_cuts);
  snapshot.leak_count = vessels_->PublishLeaks(tissue.position, snapshot.leaks);
  snapshot.ooze_count = ooze_.Publish(tissue.position, snapshot.oozes);
  stones_.Publish(snapshot.stones);
  snapshot.fluids = fluids_;
  snapshot.p_world_pool = p_pool_;
  snapshot.smoke = smoke_;
  snapshot.has_assistant = assistant_.has_value();
  if (assistant_) {
    snapshot.X_world_assistant = assistant_->CalcPose();
    snapshot.assistant_jaw = assistant_->Joints().jaw;
    snapshot.is_assistant_holding = assistant_->Held().IsHolding();
  }
  snapshot.is_gallbladder_free = is_gallbladder_free_;
  snapshot.is_in_bag = is_in_bag_;
  snapshot.is_completed = is_completed_;
}

void Operation::AddTo(OperationResult& result) const {
  surgery::FlowNetwork network = vessels_->Map().network;
  result.injuries = training::JudgeInjuries(biliary_, vessels_->Acts(), network);
  result.fluids = fluids_;
  result.bed_blood = ooze_.Lost();
  result.stones = stones_.Count();
  result.injuries.spilled_stones = result.stones.spilled;
  result.is_gallbladder_free = is_gallbladder_free_;
  result.is_in_bag = is_in_bag_;
  result.is_completed = is_completed_;
}

// --- what a judge sees

training::OperationJudge Operation::MakeJudge() const {
  const PatientTissue& tissue = *made_;
  return {training::DissectionMonitor(
              MakeDissectedAnatomy(scene_->patient, tissue.surfaces, dissected_, tissue.definition.rest),
              tissue.definition.rest),
          gallbladder_ >= 0};
}

training::OperationObservation Operation::Observe(const HandsNow& hands, const TissueNow& tissue,
                                                  const Camera& camera) const noexcept {
  training::OperationObservation now{hands.time,
                                     hands.seconds,
                                     acts_,
                                     {},
                                     *tissue.state,
                                     *vessels_,
                                     tissue.organs,
                                     camera,
                                     {is_gallbladder_free_, is_in_bag_, is_completed_},
                                     fluids_.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left,
                                     stones_.Count().spilled,
                                     p_pool_};
  for (std::size_t hand = 0; hand < now.hands.size(); ++hand) {
    training::ObservedHand& seen = now.hands[hand];
    const surgery::Grasp& grasp = (*hands.grasps)[hand];
    seen.p_world_tip = hands.X_proxy[hand].translation;
    seen.depth = hands.joints[hand].depth;
    seen.is_retracting = grasp.IsHolding() && Tool(static_cast<int>(hand)).kind != instrument::ToolKind::kBag;
    seen.is_holding_liver = grasp.surface == liver_;
    if (seen.is_retracting) seen.held = TargetOfSurface(grasp.surface);
    seen.change = hands.changes[hand];
  }
  return now;
}

void Publish(const training::OperationJudge& judge, OperationSnapshot& snapshot) noexcept {
  const training::DissectionFacts& facts = judge.Facts();
  snapshot.facts = {facts.cleared_share, facts.detached_share, facts.structures_entering};
  snapshot.critical_view = judge.View();
  snapshot.phase = judge.CurrentPhase();
  snapshot.errors = judge.Errors().Count();
  snapshot.critical_errors = judge.Errors().Count(training::Severity::kCritical);
}

void AddTo(const training::OperationJudge& judge, OperationResult& result) {
  result.errors = judge.Errors();
  result.facts = judge.Facts();
  result.critical_view = judge.View();
  result.was_critical_view_achieved = judge.WasViewAchieved();
  result.phase = judge.CurrentPhase();
}

// --- state

void Operation::HandState::VisitState(core::StateArchive& archive) {
  archive.Field("blade", blade);
  archive.Field("spread_upper", spread_upper);
  archive.Field("spread_lower", spread_lower);
  archive.FixedField("fronts", fronts);
  archive.Field("has_clip_open", has_clip_open);
  archive.Field("opened", opened);
  archive.Field("caught", caught);
  archive.Field("clips", clips);
  archive.Field("has_current", has_current);
  archive.Field("idle_seconds", idle_seconds);
  archive.Field("was_refused", was_refused);
  archive.Field("was_open", was_open);
  archive.Field("was_outside_emitted", was_outside_emitted);
  archive.Field("exchange_seconds", exchange_seconds);
}

void Operation::VisitTopology(core::StateArchive& archive) {
  archive.FixedField("organs", organs_);
  vessels_->VisitTopology(archive);
}

void Operation::VisitState(core::StateArchive& archive) {
  archive.FixedField("sheets", sheets_);
  archive.Field("vessels", *vessels_);
  archive.Field("heat", heat_);
  if (assistant_) archive.Field("assistant", *assistant_);
  archive.Field("fluids", fluids_);
  archive.Field("holes", holes_);
  archive.Field("stones", stones_);
  archive.Field("ooze", ooze_);
  archive.Field("active_tools", active_);
  archive.Field("left_hand", hands_[kLeft]);
  archive.Field("right_hand", hands_[kRight]);
  archive.Field("X_world_tools", X_world_tools_);
  for (TubeEnd& end : tube_ends_) archive.Field("is_tube_end_off", end.is_off);
  archive.Field("leaked_seen", leaked_seen_);
  archive.Field("open_area", open_area_);
  archive.Field("smoke", smoke_);
  archive.Field("topology_version", topology_version_);
  archive.Field("is_in_bag", is_in_bag_);
  archive.Field("is_completed", is_completed_);
  archive.Field("is_gallbladder_free", is_gallbladder_free_);
  archive.Field("bag_hand", bag_hand_);
  if (!archive.IsRestoring() || !archive.ok()) return;
  BeginTick();
  for (std::size_t hand = 0; hand < active_.size(); ++hand) {
    if (active_[hand] < scene_->instruments[hand].tray.size()) continue;
    active_[hand] = 0;
    archive.Fail("names a tool that is not in the tray");
  }
}

}  // namespace trocar::simulation
