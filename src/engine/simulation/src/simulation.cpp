// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation_content.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/openings.h"
#include "trocar/tissue/conserved_equilibrium.h"

namespace trocar::simulation {

using scene::CalcScriptInput;
using scene::Input;
using scene::kSpareShareForCuts;
using scene::Scene;

// --- creation

void Simulation::Content::MakeSolver() {
  device_solver = nullptr;
  const tissue::TissueModel& tissue_model = world.topology.Model();
  if (!services.make_device_solver) {
    tissue::SolverOptions options;
    options.threads = services.threads;
    if (GetScene().operation) options.spare_share = kSpareShareForCuts;
    solver = std::make_unique<tissue::EquilibriumSolver>(tissue_model, options, model->solver_model);
    solver->Prepare(GetScene().settings.solver, model->tissue->conservation.organs.size());
    return;
  }
  auto made = services.make_device_solver(tissue_model, services.threads);
  device_solver = made.get();
  solver = std::move(made);
}

base::Status Simulation::Content::MakeParts() {
  const Scene& scene = GetScene();
  const scene::PatientTissue& made = *model->tissue;
  world.topology = Topology(made.definition, model->walls);
  const tissue::TissueModel& tissue_model = world.topology.Model();
  MakeSolver();
  if (scene.operation) {
    auto operation = Operation::Make(scene, model->tissue);
    if (!operation.ok()) return operation.error();
    world.operation = std::move(*operation);
    judgement.procedure = world.operation->MakeJudge();
  }
  conservation = std::make_unique<tissue::Conservation>(tissue_model, made.conservation);
  world.tissue = model->tissue_at_start;
  world.conserved = model->conserved_at_start;
  world.good_conserved = model->conserved_at_start;
  world.guard.emplace(tissue_model);
  auto touch = ToolContacts::Make(scene, tissue_model, made.surfaces, model->tissue_at_start);
  if (!touch.ok()) return touch.error();
  world.touch = std::move(*touch);
  auto rigid = RigidStage::Make(scene);
  if (!rigid.ok()) return rigid.error();
  world.rigid = std::move(*rigid);
  patch_cutter = std::make_unique<tissue::PatchCutter>(tissue_model.Size());
  RegisterTopology();
  Begin();
  return {};
}

/// What goes on with nodes and springs that a cut, or a restored state, has changed; in this order.
void Simulation::Content::RegisterTopology() {
  Topology& topology = world.topology;
  topology.Register([this](const Topology& now, bool is_restored) {
    if (is_restored && device_solver != nullptr && now.Version() == 0) {
      MakeSolver();  // a cut had given it up
    } else {
      solver->UpdateTopology(now.Model());
    }
  });
  topology.Register([this](const Topology& now, bool is_restored) {
    if (is_restored) world.tissue = tissue::MakeRestState(now.Model());
    tick.torn_springs.resize(now.Model().SpringCount());
    tick.torn_spring_count = 0;
  });
  topology.Register([this](const Topology&, bool is_restored) { UpdateSurfaces(is_restored); });
  topology.Register(
      [this](const Topology& now, bool) { world.guard->UpdateTopology(now.Model(), world.tissue); });
}

/// Volumes and contacts go on with the organs' surfaces and the tubes as they are cut now.
void Simulation::Content::UpdateSurfaces(bool is_restored) {
  const tissue::TissueModel& tissue_model = world.topology.Model();
  std::vector<geometry::TriangleMesh> meshes;
  std::vector<tissue::ClosedOrgan> closed;
  for (std::size_t i = 0; i < GetScene().patient.organs.size(); ++i) {
    const geometry::EditableMesh& mesh = world.operation->Organ(i).Mesh();
    meshes.push_back(mesh.RestMesh());
    if (conservation->Settings().organs.empty()) continue;  // sheets have no volume
    tissue::ClosedOrgan organ = conservation->Settings().organs[i];
    organ.node_count = static_cast<std::uint32_t>(mesh.VertexCount());
    organ.triangles = meshes.back().triangles;
    for (const geometry::Triangle& lid : geometry::MakeLids(mesh)) organ.triangles.push_back(lid);
    closed.push_back(std::move(organ));
  }
  conservation->UpdateTopology(tissue_model, std::move(closed), world.conserved);
  // indices in range and finite coordinates, which is all that it asks for, a cut keeps
  const base::Status updated =
      world.touch.UpdateTopology(tissue_model, world.tissue, is_restored, meshes,
                                 world.operation->TubePieces(), world.operation->TubesOfPieces());
  TROCAR_ASSERT(updated.ok());
}

/// The first tick: hands at home, nothing touched.
void Simulation::Content::Begin() {
  const Scene& scene = GetScene();
  const Input home = CalcScriptInput(scene, 0.0);
  world.camera_holder.Reset(home.laparoscope);
  world.joints = home.hands;
  world.touch.Reset(scene, world.joints, world.tissue);
  world.rigid.Reset(scene, world.joints);
  tick.torn_springs.resize(world.topology.Model().SpringCount());
  tick.solved_condition = world.tissue.condition;
  snapshot.positions.resize(world.tissue.position.size());
  snapshot.organs.resize(world.conserved.organs.size());
  if (world.operation != nullptr) world.operation->Size(snapshot.operation);
  snapshot.facts.resize(world.operation != nullptr ? surgery::FactList::kCapacity : kMostPlainFacts);
  snapshot.objects.resize(scene.objects.size());
  judgement.monitor.Reset(scene, judgement.task);
  snapshot.task = judgement.task;
  ReadInputs(home);
  MoveCamera(home);
  HoldCamera();
  Publish();
  std::call_once(model->has_start, [this] { Save(model->start); });
}

base::Result<Simulation> Simulation::Make(std::shared_ptr<const SimulationModel> model,
                                          const Services& services) {
  auto content = std::make_unique<Content>();
  content->model = std::move(model);
  content->services = services;
  if (const base::Status made = content->MakeParts(); !made.ok()) return made.error();
  return Simulation(std::move(content));
}

base::Result<Simulation> Simulation::Make(std::shared_ptr<const Scene> scene, const Services& services) {
  auto model = MakeSimulationModel(std::move(scene), services.threads);
  if (!model.ok()) return model.error();
  return Make(std::move(*model), services);
}

Simulation::Simulation(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

// --- the tick

namespace {

template <typename Work>
void Timed(Stage stage, const Services& services, std::array<double, kStageCount>& seconds, Work&& work) {
  if (services.now == nullptr) return work();
  const std::int64_t start = services.now();
  work();
  seconds[static_cast<std::size_t>(stage)] = 1e-9 * static_cast<double>(services.now() - start);
}

}  // namespace

void Simulation::Content::StepWorld(const Input& input, bool is_judged) noexcept {
  Content& c = *this;
  const auto timed = [&c](Stage stage, auto&& work) { Timed(stage, c.services, c.tick.stage_seconds, work); };
  ++c.world.tick;
  timed(Stage::kReadInputs, [&] { c.ReadInputs(input); });
  timed(Stage::kMoveTools, [&] { c.MoveTools(input); });
  timed(Stage::kFindContacts, [&] { c.FindContacts(); });
  timed(Stage::kUseTools, [&] { c.UseTools(input); });
  timed(Stage::kHeat, [&] { c.Heat(); });
  if (is_judged) timed(Stage::kWitness, [&] { c.WitnessTools(); });
  timed(Stage::kAssistant, [&] { c.Assist(); });
  timed(Stage::kTopology, [&] { c.CutTopology(); });
  timed(Stage::kTissue, [&] { c.SolveTissue(); });
  timed(Stage::kGuard, [&] { c.GuardTissue(); });
  timed(Stage::kPlaceTools, [&] { c.PlaceTools(); });
  timed(Stage::kRigidBodies, [&] { c.StepRigidBodies(); });
  timed(Stage::kFlow, [&] { c.Flow(); });
  timed(Stage::kLooseBodies, [&] { c.MoveLoose(); });
  timed(Stage::kCamera, [&] { c.HoldCamera(); });
}

void Simulation::StepWorld(const Input& input) noexcept {
  content_->StepWorld(input, false);
}

void Simulation::Step(const Input& input) noexcept {
  Content& c = *content_;
  const auto timed = [&c](Stage stage, auto&& work) { Timed(stage, c.services, c.tick.stage_seconds, work); };
  c.StepWorld(input, true);
  timed(Stage::kJudgement, [&] { c.Judge(); });
  timed(Stage::kPublish, [&] { c.Publish(); });
  timed(Stage::kTaskRules, [&] { c.JudgeTask(); });
  c.snapshot.stage_seconds = c.tick.stage_seconds;
  c.snapshot.tick_seconds = 0;
  for (const double part : c.tick.stage_seconds) c.snapshot.tick_seconds += part;
}

// --- another start

void Simulation::Reset(const Input& start) {
  Reset();
  Content& c = *content_;
  const Scene& scene = c.GetScene();
  for (std::size_t hand = 0; hand < c.world.joints.size(); ++hand) {
    TROCAR_ASSERT(start.hands[hand].jaw == scene.instruments[hand].home.jaw);
    c.world.joints[hand] = start.hands[hand];
  }
  c.world.camera_holder.Reset(start.laparoscope);
  c.world.touch.Reset(scene, c.world.joints, c.world.tissue);
  c.world.rigid.Reset(scene, c.world.joints);
  Input home = CalcScriptInput(scene, 0.0);
  home.laparoscope = start.laparoscope;
  c.ReadInputs(home);
  c.MoveCamera(home);
  c.HoldCamera();
  c.Publish();
  c.judgement.monitor.BeginFrom(c.snapshot);
}

// --- what others ask

void Simulation::FindToolContacts(std::vector<ToolContact>& contacts) const {
  contacts.clear();
  Content& c = *content_;
  const surgery::ContactSet& set = c.world.touch.Contacts();
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    for (std::size_t i = 0; i < set.springs.size(); ++i) {
      const surgery::ContactLink& link = set.links[i];
      if (link.hand != hand) continue;
      const tissue::ContactSpring& spring = set.springs[i];
      const double depth = tissue::CalcContactDepth(spring, c.world.tissue.position);
      if (!(depth > 0.0)) continue;
      const math::Vec3 force = (-spring.stiffness * depth) * spring.normal;
      if (link.is_friction) {
        // its normal contact stands before it, and may have opened in the solve
        if (!contacts.empty() && contacts.back().hand == hand && contacts.back().surface == link.surface)
          contacts.back().force += force;
        continue;
      }
      math::Vec3 point;
      for (std::size_t k = 0; k < 3; ++k)
        point += spring.weights[k] * c.world.tissue.position[spring.nodes[k]];
      contacts.push_back({point, -1.0 * spring.normal, force, hand, link.surface, -1});
    }
    c.world.rigid.FindContacts(c.GetScene(), c.world.joints, c.world.touch, hand, contacts);
  }
}

const Scene& Simulation::GetScene() const {
  return content_->GetScene();
}
std::span<const scene::SurfaceInfo> Simulation::Surfaces() const {
  return content_->model->tissue->surfaces;
}
std::span<const scene::StrandInfo> Simulation::Strands() const {
  return content_->world.operation != nullptr ? content_->world.operation->Strands()
                                              : std::span<const scene::StrandInfo>();
}
std::optional<OperationResult> Simulation::GetOperationResult() const {
  const Content& c = *content_;
  if (c.world.operation == nullptr) return std::nullopt;
  return c.world.operation->CalcResult(c.judgement.procedure.get());
}
const Snapshot& Simulation::GetSnapshot() const {
  return content_->snapshot;
}

void Simulation::CutPatch(instrument::Hand hand, tissue::LocalPatch& patch) noexcept {
  const Content& c = *content_;
  const surgery::ContactSet& contacts = c.world.touch.Contacts();
  std::array<std::uint8_t, surgery::ContactSet::kCapacity> hands;
  for (std::size_t i = 0; i < contacts.links.size(); ++i) hands[i] = contacts.links[i].hand;
  content_->patch_cutter->Cut({c.world.topology.Model(), c.world.tissue, c.tick.load, contacts.springs,
                               std::span(hands).first(contacts.links.size()), static_cast<std::uint8_t>(hand),
                               c.world.grasps[hand].Nodes(), c.world.touch.Device(hand), c.world.forces[hand],
                               c.tick.verdict == tissue::GuardVerdict::kGood, c.world.tick, true,
                               c.GetScene().instruments[hand].p_world_port},
                              patch);
}

double Simulation::CalcEquilibriumError() const {
  const Content& c = *content_;
  tissue::TissueState state = c.world.tissue;
  state.condition = c.tick.solved_condition;
  tissue::SolverSettings exact;
  exact.kind = tissue::SolverKind::kNewtonMultigrid;
  exact.max_error = 1e-7;
  exact.newton.max_steps = 200;
  exact.newton.max_linear_iterations = 300;
  exact.outer.law_error = 1e-7;
  exact.outer.max_count = 50;
  tissue::EquilibriumSolver judge(c.world.topology.Model());
  const tissue::SolveReport solved =
      tissue::FindConservedEquilibrium(judge, exact, *c.conservation, c.tick.load, state, c.world.conserved);
  if (!solved.converged) return std::nan("");
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    error = std::max(error, math::Distance(state.position[i], c.world.tissue.position[i]));
    scale = std::max(scale, math::Distance(state.position[i], c.world.topology.Model().rest[i]));
  }
  return scale > 0.0 ? error / scale : 0.0;
}

std::string_view Simulation::DeviceName() const {
  return content_->device_solver != nullptr ? content_->device_solver->DeviceName() : std::string_view();
}

const base::Error* Simulation::DeviceError() const {
  return content_->device_solver != nullptr ? content_->device_solver->DeviceError() : nullptr;
}

}  // namespace trocar::simulation
