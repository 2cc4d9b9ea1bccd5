// SPDX-License-Identifier: Apache-2.0
#include "operation/operation.h"

#include <algorithm>
#include <cmath>

#include "operation/operated_anatomy.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"
#include "trocar/patient/pathology.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/entering_tubes.h"

namespace trocar::simulation {

using instrument::kHandCount;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::PatientTissue;
using scene::StrandInfo;
using scene::SurfaceInfo;

namespace {

/// A tool that is exchanged is out of the way at this depth [m], for this long [s].
constexpr double kOutside = 0.031, kExchangeSeconds = 0.5;
/// Where blood and bile gather, seen from the neck of the organ: to the right and behind, in Morison's pouch [m].
constexpr Vec3 kPouch{-0.015, 0.0, -0.025};
constexpr double kBelowAll = -0.03;  // under the lowest organ: what falls beside everything stops there [m]

surgery::PatternCutMonitor MakePatternCutMonitor(const scene::ModelSheet& sheet,
                                                 const geometry::EditableMesh& mesh) {
  return {{sheet.centre, sheet.half, sheet.circle}, mesh};
}

}  // namespace

base::Result<std::unique_ptr<Operation>> Operation::Make(const scene::Scene& scene,
                                                         std::shared_ptr<const PatientTissue> tissue) {
  std::unique_ptr<Operation> made(new Operation(scene, tissue->strands));
  auto stones = MakeGallstones(scene, tissue->surfaces, tissue->definition.rest);
  made->made_ = std::move(tissue);
  if (!stones.ok()) return stones.error();
  made->parts_.stones = std::move(*stones);
  made->loose_clips_.reserve(surgery::VesselActs::kMostClips);
  if (const auto status = made->MakeAll(); !status.ok()) return status.error();
  return made;
}

base::Status Operation::MakeAll() {
  const PatientTissue& tissue = *made_;
  const OperatedOrgans organs = FindOperatedOrgans(*scene_, tissue.surfaces);
  anatomy_.organ = organs.organ;
  anatomy_.host = organs.host;
  if (const auto status = MakeOrgans(); !status.ok()) return status;
  if (const auto status = MakeTubes(); !status.ok()) return status;
  FindBandStrands();
  parts_.heat =
      surgery::Electrosurgery(tissue.definition, tissue.heat_mass, scene_->operation->parameters.heat);
  attachment_ = MakeAttachment(*scene_, tissue.surfaces, strands_);
  MakeAssistant();
  const patient::Landmark* neck = FindNeck(*scene_);
  anatomy_.p_pool = (neck != nullptr ? neck->position : Vec3{}) + kPouch;
  anatomy_.deepest = kBelowAll;
  for (const Vec3& p : tissue.definition.rest) anatomy_.deepest = std::min(anatomy_.deepest, p.z + kBelowAll);
  parts_.stones.Reset();
  MakeOoze();
  for (int hand = 0; hand < kHandCount; ++hand) {
    HandState& state = hands_[static_cast<std::size_t>(hand)];
    state.blade.fronts.resize(parts_.organs.size());
    state.blade.blade.jaw = state.spread.upper.jaw = scene_->instruments[hand].home.jaw;
    state.clips.clips = Tool(hand).clips;
  }
  return {};
}

base::Status Operation::MakeOrgans() {
  const patient::Patient& patient = scene_->patient;
  for (std::size_t i = 0; i < patient.organs.size(); ++i) {
    surgery::CuttableOrganSettings settings;
    settings.wall = made_->walls[i];
    settings.cut.has_walls = static_cast<std::int32_t>(i) != anatomy_.organ && !scene_->model;
    settings.first_node = made_->surfaces[i].first_node;
    settings.first_spare = made_->first_spare[i];
    settings.spare_count = kSpare.by_organ;
    auto organ = surgery::CuttableOrgan::Make(patient.organs[i].mesh, settings);
    if (!organ.ok()) return organ.error();
    organ->ReserveFor(parts_.change);
    parts_.organs.push_back(std::move(*organ));
  }
  for (std::size_t i = 0; scene_->model && i < scene_->model->sheets.size(); ++i)
    sheets_.push_back(MakePatternCutMonitor(scene_->model->sheets[i], parts_.organs[i].Mesh()));
  return {};
}

/// Ducts and vessels, and where they enter the organ that is taken out.
base::Status Operation::MakeTubes() {
  const patient::Patient& patient = scene_->patient;
  const scene::OperationParameters& parameters = scene_->operation->parameters;
  auto vessels = scene::MakePatientVessels(patient, parameters.supplies, parameters.fluids);
  if (!vessels.ok()) return vessels.error();
  vessel_anatomy_ = std::move(vessels->anatomy);
  parts_.vessels = MakeVessels(std::move(vessels->map), patient, *made_, kSpare.tubes, parameters.vessels);
  parts_.vessels->ReserveFor(parts_.change);
  parts_.change.Clear();
  for (surgery::EnteringTube& tube : scene::FindEnteringTubes(made_->surfaces, strands_, anatomy_.organ)) {
    const SurfaceInfo& surface = made_->surfaces[patient.organs.size() + tube.tube];
    const double radius = surface.radii[tube.nodes.front() - surface.first_node];
    TubeEnd end{tube.nodes.front(), std::move(tube.end_strands), M_PI * radius * radius};
    if (!end.strands.empty()) tube_ends_.push_back(std::move(end));
  }
  return {};
}

/// Bands of a model are parted one by one.
void Operation::FindBandStrands() {
  anatomy_.band_starts.assign(1, 0);
  for (std::size_t band = 0; scene_->model && band < scene_->model->bands.size(); ++band) {
    for (std::uint32_t i = 0; i < strands_.size(); ++i) {
      if (strands_[i].band == static_cast<std::int32_t>(band)) anatomy_.band_strands.push_back(i);
    }
    anatomy_.band_starts.push_back(static_cast<std::uint32_t>(anatomy_.band_strands.size()));
  }
}

void Operation::MakeAssistant() {
  if (!scene_->operation->assistant) return;
  const scene::AssistantSetup& setup = *scene_->operation->assistant;
  const Vec3& target = setup.p_world_target;
  assistant_.emplace(setup, target);
  // the landmark moves with the organ: the nearest vertex at rest carries it
  const SurfaceInfo& surface = made_->surfaces[static_cast<std::size_t>(std::max(0, anatomy_.organ))];
  const auto& rest = made_->definition.rest;
  anatomy_.assistant_node = surface.first_node;
  for (std::uint32_t node = surface.first_node; node < surface.first_node + surface.node_count; ++node) {
    if (math::SquaredDistance(rest[node], target) <
        math::SquaredDistance(rest[anatomy_.assistant_node], target))
      anatomy_.assistant_node = node;
  }
}

/// What bleeds where the organ comes off its bed.
void Operation::MakeOoze() {
  std::vector<surgery::BedFibre> fibres;
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    const StrandInfo& strand = strands_[i];
    const bool is_bed = strand.kind == StrandInfo::Kind::kBed;
    if (!is_bed && strand.kind != StrandInfo::Kind::kAdhesion) continue;
    const bool is_b = IsOf(strand.b, anatomy_.host);
    if (is_b || IsOf(strand.a, anatomy_.host)) fibres.push_back({i, is_b ? strand.b : strand.a, is_bed});
  }
  ooze_ = surgery::BedOoze(fibres, patient::CalcPathology(scene_->patient).bed_bleeding,
                           scene_->operation->parameters.bed);
}

surgery::Fact Operation::FactOf(surgery::FactKind kind, int hand) const noexcept {
  surgery::Fact fact;
  fact.kind = kind;
  fact.hand = static_cast<std::int8_t>(hand);
  if (hand >= 0) fact.tool = Tool(hand).kind;
  return fact;
}

void Operation::AddOfTube(surgery::FactKind kind, int hand, const surgery::TubePlace& place,
                          const Vec3& position) noexcept {
  surgery::Fact fact = FactOf(kind, hand);
  fact.surface = static_cast<std::int32_t>(parts_.organs.size() + place.tube);
  fact.along = place.arc;
  fact.amount = static_cast<double>(parts_.vessels->CountCuts(place.tube));
  fact.position = position;
  fact.p_rest = parts_.vessels->RestPoint(place);
  Add(fact);
}

bool Operation::IsOf(std::uint32_t node, std::int32_t organ) const noexcept {
  if (organ < 0) return false;
  const auto i = static_cast<std::size_t>(organ);
  const std::uint32_t first = made_->surfaces[i].first_node;
  return node >= first && node < made_->first_spare[i] + kSpare.by_organ;
}

// --- tools

bool Operation::MoveTool(int hand, const scene::HandControls& controls, bool is_holding, double seconds,
                         instrument::TrocarJoints& wanted) noexcept {
  HandState& state = hands_[static_cast<std::size_t>(hand)];
  std::size_t& active = active_[static_cast<std::size_t>(hand)];
  const bool wants_other = controls.tool != active && controls.tool < scene_->instruments[hand].tray.size();
  // a stone goes out with the tool that holds it, where the trocar is wide enough
  const bool is_stuck = HoldsStone(hand) && parts_.stones.HeldDiameter(hand) > WidestTool(hand);
  const bool may = (!is_holding && !is_stuck) || parts_.retrieval.bag_hand == hand;
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
  if (parts_.retrieval.bag_hand == hand) {
    parts_.retrieval.is_completed = parts_.retrieval.is_in_bag;
    return true;
  }
  EmitRetrieved(hand, parts_.stones.TakeOut(hand));
  active = controls.tool;
  state.exchange_seconds = 0;
  state.blade.blade = {};
  state.spread = {};
  state.clips.clips = Tool(hand).clips;
  state.clips.has_clip_open = state.was_open = false;
  Add(FactOf(surgery::FactKind::kToolExchanged, hand));
  return true;
}

/// Diameter of what passes a hand's trocar: of its widest tool [m].
double Operation::WidestTool(int hand) const noexcept {
  double widest = 0;
  for (const instrument::Tool& tool : scene_->instruments[hand].tray)
    widest = std::max(widest, 2.0 * tool.shaft_radius);
  return widest;
}

void Operation::Assist(const HandsNow& hands, OperatedTissue& tissue) noexcept {
  if (!assistant_) return;
  const scene::AssistantCommand command =
      parts_.retrieval.is_in_bag ? scene::AssistantCommand::kRelease : hands.input->assistant;
  (void)assistant_->Step(command, tissue.state.position[anatomy_.assistant_node], hands.seconds,
                         tissue.organs, tissue.model, {}, tissue.state);
}

bool Operation::EndCuts() noexcept {
  if (parts_.change.nodes.empty() && parts_.change.springs.empty()) return false;
  for (const surgery::NodeChange& node : parts_.change.nodes) {
    if (node.is_new && node.from[0] != geometry::kNone) parts_.heat.CopyNode(node.from[0], node.node);
  }
  for (std::size_t i = 0; i < sheets_.size(); ++i) sheets_[i].Update(parts_.organs[i].Mesh());
  ++topology_version_;
  parts_.stones.ForgetSupports();
  return true;
}

// --- what others see

std::vector<collision::TubePiece> Operation::TubePieces() const {
  std::vector<collision::TubePiece> pieces;
  const auto& graph = parts_.vessels->Tubes().Graph();
  for (const geometry::Edge& edge : graph.edges)
    pieces.push_back({parts_.vessels->Tubes().Node(edge[0]), parts_.vessels->Tubes().Node(edge[1]),
                      std::max(graph.radii[edge[0]], graph.radii[edge[1]])});
  return pieces;
}

std::vector<std::uint32_t> Operation::TubesOfPieces() const {
  std::vector<std::uint32_t> tubes;
  for (const geometry::Edge& edge : parts_.vessels->Tubes().Graph().edges)
    tubes.push_back(parts_.vessels->TubeOf(edge[0]));
  return tubes;
}

void Operation::Size(OperationSnapshot& snapshot) const {
  const std::size_t nodes = made_->definition.rest.size();
  snapshot.strand_is_intact.assign(strands_.size(), 1);
  snapshot.blanching.assign(nodes, 0.0F);
  snapshot.charring.assign(nodes, 0.0F);
  snapshot.clips.assign(surgery::VesselActs::kMostClips, {});
  snapshot.band_is_whole.assign(anatomy_.band_starts.size() - 1, 1);
  snapshot.sheets.assign(sheets_.size(), {});
  snapshot.stones.assign(parts_.stones.Size(), {});
  snapshot.topology.tube_pieces.assign(parts_.vessels->Tubes().Graph().edges.size() + kSpare.tubes / 2, {});
  std::size_t triangles = 0;
  snapshot.topology.first_triangle.clear();
  for (const surgery::CuttableOrgan& organ : parts_.organs) {
    snapshot.topology.first_triangle.push_back(static_cast<std::uint32_t>(triangles));
    triangles += organ.Mesh().TriangleCapacity();
  }
  snapshot.topology.triangles.assign(triangles, {});
  snapshot.topology.triangle_count.assign(parts_.organs.size(), 0);
  snapshot.topology.version = std::numeric_limits<std::uint32_t>::max();
  if (scene_->operation->procedure != nullptr)
    scene::SizeSnapshot(*scene_->operation->procedure, snapshot.procedure);
}

void Operation::Publish(const tissue::TissueState& tissue, OperationSnapshot& snapshot) const noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    snapshot.tools[h] = static_cast<std::uint8_t>(active_[h]);
    snapshot.has_current[h] = hands_[h].electrode.has_current;
    snapshot.is_rinsing[h] = hands_[h].suction.is_rinsing;
    snapshot.is_aspirating[h] = hands_[h].suction.is_aspirating;
    snapshot.clips_left[h] = hands_[h].clips.clips;
  }
  std::copy(tissue.strand_is_intact.begin(), tissue.strand_is_intact.end(),
            snapshot.strand_is_intact.begin());
  for (std::size_t i = 0; i < sheets_.size(); ++i) snapshot.sheets[i] = sheets_[i].Now();
  for (std::size_t band = 0; band < snapshot.band_is_whole.size(); ++band) {
    const auto own =
        std::span(anatomy_.band_strands)
            .subspan(anatomy_.band_starts[band], anatomy_.band_starts[band + 1] - anatomy_.band_starts[band]);
    snapshot.band_is_whole[band] =
        std::all_of(own.begin(), own.end(), [&](std::uint32_t i) { return tissue.strand_is_intact[i] != 0; });
  }
  parts_.heat.Publish(snapshot.blanching, snapshot.charring);
  if (snapshot.topology.version != topology_version_) {
    for (std::size_t i = 0; i < parts_.organs.size(); ++i) {
      const surgery::CuttableOrgan& organ = parts_.organs[i];
      const auto triangles = organ.Mesh().Triangles();
      snapshot.topology.triangle_count[i] = static_cast<std::uint32_t>(triangles.size());
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
          snapshot.topology.triangles[snapshot.topology.first_triangle[i] + t][k] =
              organ.Node(triangles[t][k]);
      }
    }
    snapshot.topology.version = topology_version_;
  }
  snapshot.topology.tube_piece_count =
      parts_.vessels->PublishPieces(parts_.organs.size(), snapshot.topology.tube_pieces);
  snapshot.clip_count = parts_.vessels->PublishClips(tissue.position, snapshot.clips);
  snapshot.tube_cut_count = parts_.vessels->PublishCuts(snapshot.tube_cuts);
  snapshot.flow.leak_count = parts_.vessels->PublishLeaks(tissue.position, snapshot.flow.leaks);
  snapshot.flow.ooze_count = ooze_.Publish(tissue.position, snapshot.flow.oozes);
  parts_.stones.Publish(snapshot.stones);
  snapshot.flow.ledger = parts_.fluids;
  snapshot.flow.p_world_pool = anatomy_.p_pool;
  snapshot.smoke = parts_.smoke;
  snapshot.assistant.is_there = assistant_.has_value();
  if (assistant_) {
    snapshot.assistant.X_world_tool = assistant_->CalcPose();
    snapshot.assistant.jaw = assistant_->Joints().jaw;
    snapshot.assistant.is_holding = assistant_->Held().IsHolding();
  }
  snapshot.is_organ_free = parts_.retrieval.is_organ_free;
  snapshot.is_in_bag = parts_.retrieval.is_in_bag;
  snapshot.is_completed = parts_.retrieval.is_completed;
}

OperationResult Operation::CalcResult(const scene::ProcedureJudge* judge) const {
  OperationResult result;
  result.stones = parts_.stones.Count();
  if (judge != nullptr) result.procedure = judge->CalcResult(*parts_.vessels, result.stones);
  result.fluids = parts_.fluids;
  result.bed_blood = ooze_.Lost();
  result.is_organ_free = parts_.retrieval.is_organ_free;
  result.is_in_bag = parts_.retrieval.is_in_bag;
  result.is_completed = parts_.retrieval.is_completed;
  return result;
}

// --- what a judge sees

std::unique_ptr<scene::ProcedureJudge> Operation::MakeJudge() const {
  const scene::Procedure* procedure = scene_->operation->procedure;
  if (procedure == nullptr) return nullptr;
  return procedure->make_judge({*scene_, *made_, parts_.vessels->Map(), vessel_anatomy_});
}

surgery::OperationObservation Operation::Observe(const HandsNow& hands, const OperatedTissue& tissue,
                                                 const instrument::Camera& camera) const noexcept {
  surgery::OperationObservation now{
      hands.time,
      hands.seconds,
      facts_->All(),
      {},
      tissue.state,
      *parts_.vessels,
      tissue.organs,
      camera,
      {parts_.retrieval.is_organ_free, parts_.retrieval.is_in_bag, parts_.retrieval.is_completed},
      parts_.fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left,
      parts_.stones.Count().spilled,
      anatomy_.p_pool};
  for (std::size_t hand = 0; hand < now.hands.size(); ++hand) {
    surgery::HandObservation& seen = now.hands[hand];
    const surgery::Grasp& grasp = tissue.grasps[hand];
    seen.tool = Tool(static_cast<int>(hand)).kind;
    seen.p_world_tip = hands.X_proxy[hand].translation;
    seen.depth = hands.joints[hand].depth;
    seen.is_holding = grasp.IsHolding() && !instrument::AbilitiesOf(seen.tool).is_bag;
    seen.held_surface = grasp.surface;
    seen.change = hands.changes[hand];
  }
  return now;
}

void Publish(const scene::ProcedureJudge& judge, OperationSnapshot& snapshot) noexcept {
  judge.Publish(snapshot.procedure);
  snapshot.errors = judge.Errors().Count();
  snapshot.critical_errors = judge.Errors().Count(surgery::Severity::kCritical);
}

// --- state

void Operation::HandState::VisitState(base::StateArchive& archive) {
  if (archive.IsRestoring()) suction = {};
  archive.Field("blade", blade.blade);
  archive.Field("spread_upper", spread.upper);
  archive.Field("spread_lower", spread.lower);
  archive.FixedField("fronts", blade.fronts);
  archive.Field("has_clip_open", clips.has_clip_open);
  archive.Field("opened", clips.opened);
  archive.Field("caught", clips.caught);
  archive.Field("clips", clips.clips);
  archive.Field("has_current", electrode.has_current);
  archive.Field("idle_seconds", electrode.idle_seconds);
  archive.Field("was_refused", was_refused);
  archive.Field("was_open", was_open);
  archive.Field("was_outside_emitted", was_outside_emitted);
  archive.Field("exchange_seconds", exchange_seconds);
}

void Operation::VisitTopology(base::StateArchive& archive) {
  archive.FixedField("organs", parts_.organs);
  parts_.vessels->VisitTopology(archive);
}

void Operation::VisitState(base::StateArchive& archive) {
  archive.FixedField("sheets", sheets_);
  archive.Field("vessels", *parts_.vessels);
  archive.Field("heat", parts_.heat);
  if (assistant_) archive.Field("assistant", *assistant_);
  archive.Field("fluids", parts_.fluids);
  archive.Field("holes", parts_.wall.holes);
  archive.Field("stones", parts_.stones);
  archive.Field("ooze", ooze_);
  archive.Field("active_tools", active_);
  archive.Field("left_hand", hands_[kLeft]);
  archive.Field("right_hand", hands_[kRight]);
  archive.Field("X_world_tools", X_world_tools_);
  for (TubeEnd& end : tube_ends_) archive.Field("is_tube_end_off", end.is_off);
  archive.Field("leaked_seen", parts_.wall.leaked_seen);
  archive.Field("open_area", parts_.wall.open_area);
  archive.Field("smoke", parts_.smoke);
  archive.Field("topology_version", topology_version_);
  archive.Field("is_in_bag", parts_.retrieval.is_in_bag);
  archive.Field("is_completed", parts_.retrieval.is_completed);
  archive.Field("is_organ_free", parts_.retrieval.is_organ_free);
  archive.Field("bag_hand", parts_.retrieval.bag_hand);
  if (!archive.IsRestoring() || !archive.ok()) return;
  for (std::size_t hand = 0; hand < active_.size(); ++hand) {
    if (active_[hand] < scene_->instruments[hand].tray.size()) continue;
    active_[hand] = 0;
    archive.Fail("names a tool that is not in the tray");
  }
}

}  // namespace trocar::simulation
