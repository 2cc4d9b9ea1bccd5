// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "operation/operation.h"
#include "patient_tissue.h"
#include "rigid_stage.h"
#include "task_monitor.h"
#include "tool_contacts.h"
#include "trocar/core/clock.h"
#include "trocar/core/state_hash.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/openings.h"
#include "trocar/surgery/grasp.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/damage.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/state_guard.h"
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

namespace trocar::session {
namespace {

/// Gravity in which the organs were imaged: the body lay on its back [m/s^2].
constexpr Vec3 kImagingGravity{0, 0, -9.81};
/// No hand is faster; a device that jumps is slowed to this (faults D5) [m/s], [rad/s].
constexpr double kMaxTipSpeed = 2.0;
constexpr double kMaxTurnRate = 20.0;

/// Relative change of a filled organ's volume below which it counts as at rest [-].
constexpr double kFilledTolerance = 1e-4;

/// Gravity in the patient's frame when the table is tilted [m/s^2].
Vec3 CalcGravity(const LiveSettings& settings) noexcept {
  const double head = settings.head_up, right = settings.right_up;
  return settings.gravity *
         Vec3{std::sin(right) * std::cos(head), -std::sin(head), -std::cos(right) * std::cos(head)};
}

}  // namespace

/// Model: constant while running. State: what a tick changes. Scratch: rebuilt every tick.
struct Simulation::Content {
  // model
  std::shared_ptr<const Scene> scene;
  tissue::TissueModel tissue_model;
  std::vector<SurfaceInfo> surfaces;
  std::vector<double> max_elongation;
  std::vector<std::int32_t> strand_organs;
  tissue::TissueState tissue_at_start;
  tissue::ConservationState conserved_at_start;
  std::vector<std::int32_t> spring_organs;  // (springs) organ whose wall it is part of, or -1
  std::vector<double> spring_areas;         // (springs) part of that organ's surface [m^2]
  bool walls_tear = false;
  std::int32_t hollow_organ = -1;  // leaks when its wall tears
  surgery::GraspSettings grasp_settings;
  tissue::TissueDefinition definition_at_start;  // where there is an operation, which changes it
  std::vector<std::int32_t> spring_organs_at_start;
  std::vector<double> spring_areas_at_start;

  // state
  std::unique_ptr<Operation> operation;
  tissue::TissueDefinition definition_now;
  std::uint32_t topology_version = 0;
  std::uint64_t tick = 0;
  tissue::TissueState tissue;
  tissue::ConservationState conserved;
  std::array<instrument::TrocarJoints, kHandCount> joints;
  ToolContacts touch;
  std::array<surgery::Grasp, kHandCount> grasps;
  std::unique_ptr<tissue::StateGuard> guard;
  RigidStage rigid;
  TaskMonitor monitor;

  // scratch
  std::unique_ptr<tissue::EquilibriumSolver> solver;
  const tissue_cuda::GpuOrCpuSolver* gpu_solver = nullptr;  // the same, where the GPU was asked for
  std::unique_ptr<tissue::Conservation> conservation;
  LiveSettings settings;
  tissue::TissueLoad load;
  tissue::SolveReport report;
  tissue::ConservationState good_conserved;             // after the last good tick
  std::vector<tissue::NodeCondition> solved_condition;  // a grasp may slip once the forces are known
  std::array<surgery::GraspChange, kHandCount> changes{};
  std::array<std::int32_t, kHandCount> changed_organs{};
  std::array<Vec3, kHandCount> forces;
  std::array<std::int32_t, kHandCount> touched_organs{};
  tissue::GuardVerdict verdict = tissue::GuardVerdict::kGood;
  bool was_frozen = false;
  bool were_tools_touching = false;
  std::array<std::uint32_t, 8> torn{};  // lowest of the strands that tore in this tick
  std::size_t torn_count = 0;
  std::vector<std::uint32_t> torn_springs;  // (springs) those of the walls that tore in this tick, first
  std::size_t torn_spring_count = 0;
  HandsNow hands;
  int thread_count = 1;
  Snapshot snapshot;
  std::unique_ptr<haptics::PatchCutter> patch_cutter;

  void ReadInputs(const Input& input) noexcept;
  void MoveInstruments(const Input& input) noexcept;
  ToolsNow GetTools() const noexcept;
  void FindContacts() noexcept;
  void ActOnTissue() noexcept;
  void Solve() noexcept;
  void CheckState() noexcept;
  void UpdateHierarchy() noexcept;
  void DetectEvents() noexcept;
  void Publish(const Input& input) noexcept;
  void Note(EventKind kind, int hand, std::int32_t organ, double force, std::int32_t object = -1) noexcept;
  void TearTissue() noexcept;
  void SetWalls(const tissue::TissueDefinition& definition, std::vector<std::int32_t> organs_of_springs);
  core::Status Fill(const std::vector<double>& internal_pressure);
  void Reset();
  void MakeSolver(int threads, SolveOn solve_on);
  const instrument::Tool& ToolOf(int hand) const noexcept {
    return operation != nullptr ? operation->Tool(hand) : scene->instruments[hand].tool;
  }
  void Operate(const Input& input) noexcept;
  TissueNow GetTissue() noexcept;
  void ChangeTopology();
  void FollowTopology();
};

// --- the stages of a tick

void Simulation::Content::ReadInputs(const Input& input) noexcept {
  settings = ClampSettings(input.settings);
  load.gravity = CalcGravity(settings) - kImagingGravity;
  load.stiffness_scale = settings.stiffness_scale;
  load.shape_scale = settings.shape_scale;
}

void Simulation::Content::MoveInstruments(const Input& input) noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    instrument::JointLimits limits;
    limits.max_jaw = ToolOf(hand).max_jaw;
    instrument::TrocarJoints wanted = instrument::ClampJoints(input.hands[hand], limits);
    if (operation != nullptr && !operation->MoveTool(hand, input.controls[hand], grasps[hand].IsHolding(),
                                                     scene->tick_seconds, wanted))
      Note(EventKind::kExchangeRefused, hand, grasps[hand].surface, 0.0);
    joints[hand] =
        instrument::LimitSpeed(joints[hand], wanted, kMaxTipSpeed, kMaxTurnRate, scene->tick_seconds);
    joints[hand].jaw = rigid.StopJaw(hand, joints[hand].jaw);
  }
}

ToolsNow Simulation::Content::GetTools() const noexcept {
  ToolsNow now{joints, {}, {}};
  for (int hand = 0; hand < kHandCount; ++hand) {
    now.grasped_surfaces[hand] = grasps[hand].surface;
    now.tools[hand] = &ToolOf(hand);
  }
  return now;
}

void Simulation::Content::FindContacts() noexcept {
  load.contacts = touch.Find(*scene, GetTools(), tissue);
  rigid.FindObstacles(*scene, joints, touch);
}

void Simulation::Content::ActOnTissue() noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const std::int32_t held = grasps[hand].surface;
    changes[hand] = surgery::GraspChange::kNone;
    changed_organs[hand] = held;
    const instrument::Tool& tool = ToolOf(hand);
    const bool can_grasp =
        tool.kind == instrument::ToolKind::kGrasper || tool.kind == instrument::ToolKind::kDissector;
    if (!can_grasp && !grasps[hand].IsHolding()) continue;
    changes[hand] =
        surgery::UpdateGrasp(tool, touch.Proxy(hand), touch.Device(hand), joints[hand].jaw, touch.Organs(),
                             &touch.Tubes(), tissue_model, grasp_settings, grasps[hand], tissue);
    changed_organs[hand] = changes[hand] == surgery::GraspChange::kReleased ? held : grasps[hand].surface;
  }
  // nodes that a tool presses are the paper's second condition
  for (std::size_t i = 0; i < tissue.condition.size(); ++i) {
    if (tissue.condition[i] == tissue::NodeCondition::kExternalForce)
      tissue.condition[i] = tissue::NodeCondition::kFree;
  }
  for (const auto& spring : load.contacts) {
    if (!(tissue::CalcContactDepth(spring, tissue.position) > 0.0)) continue;
    for (const auto node : spring.nodes) {
      if (tissue.condition[node] == tissue::NodeCondition::kFree)
        tissue.condition[node] = tissue::NodeCondition::kExternalForce;
    }
  }
}

TissueNow Simulation::Content::GetTissue() noexcept {
  return {&tissue_model, &definition_now, &tissue,       conservation.get(),
          &conserved,    touch.Organs(),  &touch.Tubes()};
}

/// What the tools do beyond grasping and pushing.
void Simulation::Content::Operate(const Input& input) noexcept {
  instrument::JointLimits limits;
  limits.min_depth = 0.01;
  hands.input = &input;
  hands.joints = joints;
  for (int hand = 0; hand < kHandCount; ++hand)
    hands.X_proxy[hand] = touch.Proxy(hand), hands.X_device[hand] = touch.Device(hand);
  hands.changes = changes;
  hands.grasps = &grasps;
  hands.camera = {CalcLaparoscopePose(scene->laparoscope, instrument::ClampJoints(input.laparoscope, limits)),
                  scene->laparoscope.field_of_view};
  hands.time = static_cast<double>(tick) * scene->tick_seconds;
  hands.seconds = scene->tick_seconds;
  if (operation->Act(hands, GetTissue())) ChangeTopology();
}

/// Takes a cut into model, solver, volumes and contacts, in the tick that made it. Allocates.
void Simulation::Content::ChangeTopology() {
  const surgery::TopologyChange& change = operation->Change();
  const auto origins = surgery::ApplyChange(change, definition_now);
  tissue_model = tissue::MakeTissueModel(definition_now);
  surgery::ApplyChange(change, origins, tissue_model, tissue);
  // a spring that is new is part of the organ whose node it has
  std::vector<std::int32_t> organs(origins.size(), -1);
  std::vector<double> areas(origins.size(), 0.0);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] == geometry::kNone) continue;
    organs[i] = spring_organs[origins[i]];
    areas[i] = spring_areas[origins[i]];
  }
  spring_organs = std::move(organs);
  spring_areas = std::move(areas);
  torn_springs.resize(tissue_model.SpringCount());
  FollowTopology();
}

/// Builds anew what was made for the model of before.
void Simulation::Content::FollowTopology() {
  MakeSolver(thread_count, SolveOn::kProcessor);
  std::vector<geometry::TriangleMesh> meshes;
  std::vector<tissue::ClosedOrgan> closed;
  for (std::size_t i = 0; i < scene->patient.organs.size(); ++i) {
    const geometry::EditableMesh& mesh = operation->Organ(i).Mesh();
    meshes.push_back(mesh.RestMesh());
    tissue::ClosedOrgan organ = conservation->Settings().organs[i];
    organ.node_count = static_cast<std::uint32_t>(mesh.VertexCount());
    organ.triangles = meshes.back().triangles;
    for (const geometry::Triangle& lid : geometry::MakeLids(mesh)) organ.triangles.push_back(lid);
    closed.push_back(std::move(organ));
  }
  conservation->Follow(tissue_model, std::move(closed), conserved);
  guard->Follow(tissue_model, tissue);
  patch_cutter = std::make_unique<haptics::PatchCutter>(tissue_model.Size());
  if (!touch.Follow(tissue_model, tissue, meshes, operation->TubePieces(), operation->TubesOfPieces()).ok())
    return;  // what cannot be touched is seen all the same
}

void Simulation::Content::Solve() noexcept {
  if (guard->IsFrozen()) return;
  std::copy(tissue.condition.begin(), tissue.condition.end(), solved_condition.begin());
  load.external_force = {};
  report = tissue::SolveConserving(*solver, settings.solver, scene->tick_seconds, *conservation, load, tissue,
                                   conserved);
}

void Simulation::Content::CheckState() noexcept {
  verdict = guard->Check(tissue, report.is_finite);
  // what a bad tick left in the pressures and frames goes with it
  if (verdict == tissue::GuardVerdict::kGood) {
    good_conserved = conserved;
  } else {
    conserved = good_conserved;
  }
  const bool is_good = verdict == tissue::GuardVerdict::kGood;
  const auto touched = touch.CalcTouch(tissue, is_good);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const Vec3 held = solver->CalcReaction(load, tissue, grasps[hand].Nodes());
    touched_organs[hand] = grasps[hand].IsHolding() ? grasps[hand].surface : touched[hand].surface;
    forces[hand] = is_good ? touched[hand].force + held : Vec3{};
    if (!is_good) continue;
    const std::int32_t surface = grasps[hand].surface;
    if (surgery::UpdateSlip(math::Norm(held), grasp_settings, tissue_model, grasps[hand], tissue) ==
        surgery::GraspChange::kSlipped) {
      changes[hand] = surgery::GraspChange::kSlipped;
      changed_organs[hand] = surface;
    }
  }
}

void Simulation::Content::TearTissue() noexcept {
  torn_count = verdict == tissue::GuardVerdict::kGood
                   ? tissue::TearStrands(tissue_model, max_elongation, tissue, torn)
                   : 0;
  torn_spring_count = 0;
  if (!walls_tear || verdict != tissue::GuardVerdict::kGood) return;
  torn_spring_count = tissue::TearSprings(tissue_model, scene->tick_seconds, tissue, torn_springs);
  // a hollow organ leaks through what the spring no longer closes
  for (std::size_t i = 0; i < torn_spring_count; ++i) {
    const std::int32_t organ = spring_organs[torn_springs[i]];
    if (organ == hollow_organ)
      conservation->Perforate(static_cast<std::size_t>(organ), spring_areas[torn_springs[i]], conserved);
  }
}

void Simulation::Content::UpdateHierarchy() noexcept {
  touch.Update(*scene, GetTools(), tissue);
  rigid.Step(*scene, joints, touch, CalcGravity(settings));
  for (int hand = 0; hand < kHandCount; ++hand) forces[hand] = forces[hand] + rigid.ForceOn(hand);
}

void Simulation::Content::Note(EventKind kind, int hand, std::int32_t organ, double force,
                               std::int32_t object) noexcept {
  snapshot.events[snapshot.event_count % snapshot.events.size()] = {kind, tick, hand, organ, force, object};
  ++snapshot.event_count;
}

void Simulation::Content::DetectEvents() noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const double force = math::Norm(forces[hand]);
    switch (changes[hand]) {
      case surgery::GraspChange::kNone:
        break;
      case surgery::GraspChange::kGrasped:
        Note(EventKind::kGrasp, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kMissed:
        Note(EventKind::kGraspMissed, hand, -1, 0.0);
        break;
      case surgery::GraspChange::kReleased:
        Note(EventKind::kRelease, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kSlipped:
        Note(EventKind::kSlip, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kDamaged:
        Note(EventKind::kPinchDamage, hand, changed_organs[hand], grasps[hand].pinch);
        break;
    }
  }
  rigid.NoteChanges([&](EventKind kind, int hand, std::int32_t object) {
    Note(kind, hand, -1, math::Norm(forces[hand]), object);
  });
  if (touch.AreToolsTouching() && !were_tools_touching) Note(EventKind::kToolsTouch, -1, -1, 0.0);
  were_tools_touching = touch.AreToolsTouching();
  if (torn_count > 0) Note(EventKind::kTear, -1, strand_organs[torn[0]], 0.0);
  if (torn_spring_count > 0) Note(EventKind::kTear, -1, spring_organs[torn_springs[0]], 0.0);
  if (verdict == tissue::GuardVerdict::kRestored) Note(EventKind::kStateRestored, -1, -1, 0.0);
  if (verdict == tissue::GuardVerdict::kFrozen && !was_frozen) Note(EventKind::kOrganFrozen, -1, -1, 0.0);
  was_frozen = verdict == tissue::GuardVerdict::kFrozen;
}

void Simulation::Content::Publish(const Input& input) noexcept {
  snapshot.tick = tick;
  snapshot.time = static_cast<double>(tick) * scene->tick_seconds;
  std::copy(tissue.position.begin(), tissue.position.end(), snapshot.positions.begin());
  for (int hand = 0; hand < kHandCount; ++hand) {
    InstrumentSnapshot& tool = snapshot.instruments[hand];
    tool.X_world_tool = touch.Proxy(hand);
    tool.joints = joints[hand];
    tool.force = forces[hand];
    tool.is_grasping = grasps[hand].IsHolding() || rigid.HeldBy(hand) >= 0;
    tool.object = rigid.HeldBy(hand);
    tool.is_touching = touched_organs[hand] >= 0;
    tool.organ = touched_organs[hand];
    tool.X_world_device = touch.Device(hand);
    tool.pinch = std::max(grasps[hand].pinch, rigid.Pinch(hand));
    tool.overlap = touch.Overlap(hand);
    tool.is_touching_tool = touch.AreToolsTouching();
  }
  snapshot.contacts = touch.Contacts().springs.size();
  snapshot.dropped_contacts = touch.Contacts().dropped;
  instrument::JointLimits limits;
  limits.min_depth = 0.01;
  snapshot.X_world_laparoscope =
      CalcLaparoscopePose(scene->laparoscope, instrument::ClampJoints(input.laparoscope, limits));
  for (std::size_t i = 0; i < conserved.organs.size(); ++i) {
    const tissue::OrganVolume& organ = conserved.organs[i];
    snapshot.organs[i] = {organ.volume, organ.target, organ.pressure, organ.leaked};
  }
  if (operation != nullptr) operation->Publish(tissue, snapshot.operation);
  snapshot.residual = report.residual;
  snapshot.iterations = report.iterations;
  snapshot.gravity = CalcGravity(settings);
  rigid.Publish(snapshot.objects);
  monitor.Update(*scene, snapshot);
}

// --- creation

void Simulation::Content::Reset() {
  tick = 0;
  const bool was_cut = operation != nullptr && !operation->IsUncut();
  if (operation != nullptr) (void)operation->Reset();
  tissue = tissue_at_start;
  conserved = conserved_at_start;
  if (was_cut) {
    definition_now = definition_at_start;
    tissue_model = tissue::MakeTissueModel(definition_now);
    spring_organs = spring_organs_at_start;
    spring_areas = spring_areas_at_start;
    torn_springs.resize(tissue_model.SpringCount());
    guard = std::make_unique<tissue::StateGuard>(tissue_model);
    FollowTopology();
    conserved = conserved_at_start;
  }
  conservation->Reset();
  guard = std::make_unique<tissue::StateGuard>(tissue_model);
  const Input home = CalcScriptInput(*scene, 0.0);
  for (int hand = 0; hand < kHandCount; ++hand) {
    joints[hand] = home.hands[hand];
    grasps[hand] = {};
    forces[hand] = {};
    touched_organs[hand] = -1;
  }
  touch.Reset(*scene, joints, tissue);
  rigid.Reset(*scene, joints);
  load = {};
  report = {};
  was_frozen = were_tools_touching = false;
  torn_count = torn_spring_count = 0;
  snapshot = {};
  snapshot.positions.resize(tissue_model.Size());
  solved_condition = tissue.condition;
  good_conserved = conserved;
  snapshot.organs.resize(conserved.organs.size());
  if (operation != nullptr) operation->Size(snapshot.operation);
  snapshot.objects.resize(scene->objects.size());
  monitor.Reset(*scene, snapshot);
  ReadInputs(home);
  Publish(home);
}

void Simulation::Content::MakeSolver(int threads, SolveOn solve_on) {
  gpu_solver = nullptr;
  if (solve_on == SolveOn::kProcessor) {
    solver = std::make_unique<tissue::EquilibriumSolver>(tissue_model, threads);
    return;
  }
  auto made = std::make_unique<tissue_cuda::GpuOrCpuSolver>(tissue_model, threads,
                                                            tissue_cuda::GpuSolver::Make(tissue_model));
  gpu_solver = made.get();
  solver = std::move(made);
}

/// What tears in the walls, and how large a hole it leaves: a spring's part of its organ's surface.
void Simulation::Content::SetWalls(const tissue::TissueDefinition& definition,
                                   std::vector<std::int32_t> organs_of_springs) {
  spring_organs = std::move(organs_of_springs);
  walls_tear = tissue::HasTearingSprings(tissue_model);
  hollow_organ = scene->patient.FindOrgan("gallbladder");
  torn_springs.resize(tissue_model.SpringCount());
  spring_areas.resize(tissue_model.SpringCount());
  std::vector<double> areas, square_lengths(scene->patient.organs.size(), 0.0);
  for (const anatomy::Organ& organ : scene->patient.organs)
    areas.push_back(geometry::CalcArea(organ.mesh.positions, organ.mesh.triangles));
  const auto square_length = [&](std::size_t i) {
    return definition.springs[i].rest_length * definition.springs[i].rest_length;
  };
  for (std::size_t i = 0; i < spring_organs.size(); ++i) square_lengths[spring_organs[i]] += square_length(i);
  for (std::size_t i = 0; i < spring_organs.size(); ++i) {
    const std::int32_t organ = spring_organs[i];
    spring_areas[i] = areas[organ] * square_length(i) / square_lengths[organ];
  }
  spring_organs.resize(tissue_model.SpringCount(), -1);
}

/// Rest, with tense organs filled.
core::Status Simulation::Content::Fill(const std::vector<double>& internal_pressure) {
  tissue_at_start = tissue::MakeRestState(tissue_model);
  conserved_at_start = conservation->MakeState(tissue_at_start);
  for (std::size_t organ = 0; organ < internal_pressure.size(); ++organ) {
    if (internal_pressure[organ] == 0.0) continue;
    const double unrest = tissue::FillToPressure(*solver, organ, internal_pressure[organ], {}, *conservation,
                                                 tissue_at_start, conserved_at_start);
    if (!(unrest < kFilledTolerance)) {
      return core::Error{
          core::ErrorCode::kSceneInvalid,
          "the wall of \"" + surfaces[organ].name +
              "\" does not hold its internal pressure; lower internal_pressure_pa, or make the "
              "wall stiffer"};
    }
  }
  return {};
}

core::Result<Simulation> Simulation::Make(std::shared_ptr<const Scene> scene, int threads, SolveOn solve_on) {
  const bool is_operation = scene->operation.has_value();
  auto made = MakePatientTissue(*scene, is_operation ? Operation::kSpare : SpareNodes{});
  if (!made.ok()) return made.error();
  auto content = std::make_unique<Content>();
  content->scene = std::move(scene);
  content->tissue_model = tissue::MakeTissueModel(made->definition);
  content->patch_cutter = std::make_unique<haptics::PatchCutter>(content->tissue_model.Size());
  content->thread_count = std::max(1, threads);
  content->MakeSolver(content->thread_count, solve_on);
  if (is_operation) {
    auto operation = Operation::Make(*content->scene, *made);
    if (!operation.ok()) return operation.error();
    content->operation = std::move(*operation);
    content->definition_now = content->definition_at_start = made->definition;
  }
  content->surfaces = std::move(made->surfaces);
  made->conservation.imaging_gravity = kImagingGravity;
  content->conservation =
      std::make_unique<tissue::Conservation>(content->tissue_model, std::move(made->conservation));
  content->max_elongation = std::move(made->max_elongation);
  content->strand_organs = std::move(made->strand_organs);
  content->SetWalls(made->definition, std::move(made->spring_organs));
  if (const auto filled = content->Fill(made->internal_pressure); !filled.ok()) return filled.error();
  auto touch =
      ToolContacts::Make(*content->scene, content->tissue_model, content->surfaces, content->tissue_at_start);
  if (!touch.ok()) return touch.error();
  content->touch = std::move(*touch);
  content->spring_organs_at_start = content->spring_organs;
  content->spring_areas_at_start = content->spring_areas;
  auto rigid = RigidStage::Make(*content->scene);
  if (!rigid.ok()) return rigid.error();
  content->rigid = std::move(*rigid);
  content->Reset();
  return Simulation(std::move(content));
}

Simulation::Simulation(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

void Simulation::Reset() {
  content_->Reset();
}

void Simulation::Step(const Input& input) noexcept {
  Content& c = *content_;
  std::array<double, kStageCount> seconds{};
  const auto timed = [&](Stage stage, auto&& work) {
    const std::int64_t start = core::NowNanoseconds();
    work();
    seconds[static_cast<int>(stage)] = 1e-9 * static_cast<double>(core::NowNanoseconds() - start);
  };
  ++c.tick;
  timed(Stage::kReadInputs, [&] { c.ReadInputs(input); });
  timed(Stage::kMoveInstruments, [&] { c.MoveInstruments(input); });
  timed(Stage::kFindContacts, [&] { c.FindContacts(); });
  timed(Stage::kActOnTissue, [&] {
    c.ActOnTissue();
    if (c.operation != nullptr) c.Operate(input);
  });
  timed(Stage::kSolve, [&] { c.Solve(); });
  timed(Stage::kCheckState, [&] { c.CheckState(), c.TearTissue(); });
  timed(Stage::kUpdateHierarchy, [&] { c.UpdateHierarchy(); });
  timed(Stage::kDetectEvents, [&] {
    c.DetectEvents();
    if (c.operation == nullptr) return;
    c.hands.changes = c.changes;  // a grasp may have slipped in the solve
    c.operation->Judge(c.hands, c.GetTissue());
  });
  timed(Stage::kPublish, [&] { c.Publish(input); });
  c.snapshot.stage_seconds = seconds;
  c.snapshot.tick_seconds = 0;
  for (const double part : seconds) c.snapshot.tick_seconds += part;
}

const Scene& Simulation::GetScene() const {
  return *content_->scene;
}
std::span<const SurfaceInfo> Simulation::Surfaces() const {
  return content_->surfaces;
}
std::span<const StrandInfo> Simulation::Strands() const {
  return content_->operation != nullptr ? content_->operation->Strands() : std::span<const StrandInfo>();
}
std::optional<OperationResult> Simulation::GetOperationResult() const {
  if (content_->operation == nullptr) return std::nullopt;
  return content_->operation->Result();
}
const Snapshot& Simulation::GetSnapshot() const {
  return content_->snapshot;
}

void Simulation::CutPatch(Hand hand, haptics::LocalPatch& patch) noexcept {
  const Content& c = *content_;
  const surgery::ContactSet& contacts = c.touch.Contacts();
  std::array<std::uint8_t, surgery::ContactSet::kCapacity> hands;
  for (std::size_t i = 0; i < contacts.links.size(); ++i) hands[i] = contacts.links[i].hand;
  content_->patch_cutter->Cut(
      {c.tissue_model, c.tissue, c.load, contacts.springs, std::span(hands).first(contacts.links.size()),
       static_cast<std::uint8_t>(hand), c.grasps[hand].Nodes(), c.touch.Device(hand), c.forces[hand],
       c.verdict == tissue::GuardVerdict::kGood, c.tick, true, c.scene->instruments[hand].p_world_port},
      patch);
}

double Simulation::CalcEquilibriumError() const {
  const Content& c = *content_;
  tissue::TissueState state = c.tissue;
  state.condition = c.solved_condition;
  tissue::SolverSettings exact;
  exact.kind = tissue::SolverKind::kNewtonMultigrid;
  exact.max_error = 1e-7;
  exact.max_newton_steps = 200;
  exact.max_linear_iterations = 300;
  exact.law_error = 1e-7;
  exact.max_rounds = 50;
  tissue::EquilibriumSolver judge(c.tissue_model, 1);
  const tissue::SolveReport solved = judge.Solve(exact, c.load, state);
  if (!solved.converged) return std::nan("");
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    error = std::max(error, math::Distance(state.position[i], c.tissue.position[i]));
    scale = std::max(scale, math::Distance(state.position[i], c.tissue_model.rest[i]));
  }
  return scale > 0.0 ? error / scale : 0.0;
}

std::string_view Simulation::GpuName() const {
  const auto* gpu = content_->gpu_solver != nullptr ? content_->gpu_solver->Gpu() : nullptr;
  return gpu != nullptr ? std::string_view(gpu->name) : std::string_view();
}

const core::Error* Simulation::GpuError() const {
  const auto* solver = content_->gpu_solver;
  return solver != nullptr && solver->GpuError() ? &*solver->GpuError() : nullptr;
}

std::uint64_t Simulation::Hash() const {
  const Content& c = *content_;
  core::StateHash hash;
  hash.Add(c.tick);
  for (const Vec3& p : c.tissue.position) hash.Add(p.x), hash.Add(p.y), hash.Add(p.z);
  for (const auto condition : c.tissue.condition) hash.Add(static_cast<std::uint64_t>(condition));
  for (const tissue::OrganVolume& organ : c.conserved.organs) {
    for (const double value : {organ.target, organ.pressure, organ.opening_area, organ.leaked})
      hash.Add(value);
  }
  for (std::uint32_t region = 0; region < c.conserved.regions.count; ++region) {
    const Pose& X = c.conserved.X_world_rest[region];
    for (const double value : {X.rotation.w, X.rotation.x, X.rotation.y, X.rotation.z, X.translation.x,
                               X.translation.y, X.translation.z}) {
      hash.Add(value);
    }
  }
  for (const auto intact : c.tissue.strand_is_intact) hash.Add(std::uint64_t{intact});
  // a spring that is whole and unharmed says nothing: hashes stay when springs learn to tear
  for (std::size_t i = 0; i < c.tissue.spring_factor.size(); ++i) {
    const double factor = c.tissue.spring_factor[i], damage = c.tissue.spring_damage[i];
    if (factor == 1.0 && damage == 0.0) continue;
    hash.Add(std::uint64_t{i}), hash.Add(factor), hash.Add(damage);
  }
  for (int hand = 0; hand < kHandCount; ++hand) {
    const instrument::TrocarJoints& j = c.joints[hand];
    for (const double joint : {j.pan, j.tilt, j.spin, j.depth, j.jaw}) hash.Add(joint);
    for (const auto node : c.grasps[hand].Nodes()) hash.Add(std::uint64_t{node});
    const Vec3& force = c.forces[hand];
    hash.Add(force.x), hash.Add(force.y), hash.Add(force.z);
  }
  c.touch.AddTo(hash);
  if (c.operation != nullptr) c.operation->AddTo(hash);
  c.rigid.AddTo(hash);
  c.monitor.AddTo(c.snapshot.task, hash);
  return hash.Value();
}

}  // namespace trocar::session
