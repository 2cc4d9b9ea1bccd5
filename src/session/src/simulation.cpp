// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation_content.h"
#include "trocar/core/assert.h"
#include "trocar/core/clock.h"
#include "trocar/core/state_hash.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/tissue/conserved_equilibrium.h"
#include "trocar/tissue/damage.h"

namespace trocar::session {
namespace {

/// Relative change of a filled organ's volume below which it counts as at rest [-].
constexpr double kFilledTolerance = 1e-4;

}  // namespace

// --- creation

void Simulation::Content::Reset() {
  tick = 0;
  const bool was_cut = operation != nullptr && !operation->IsUncut();
  if (operation != nullptr) {
    const core::Status reset = operation->Reset();
    TROCAR_ASSERT(reset.ok());  // the same scene could be made before
  }
  tissue = tissue_at_start;
  conserved = conserved_at_start;
  if (was_cut) {
    definition_now = definition_at_start;
    tissue_model = tissue::MakeTissueModel(definition_now);
    spring_organs = spring_organs_at_start;
    spring_areas = spring_areas_at_start;
    torn_springs.resize(tissue_model.SpringCount());
    FollowTopology();
    if (gpu_solver != nullptr) MakeSolver(thread_count, SolveOn::kGpu);  // the cut had given it up
    conserved = conserved_at_start;
  }
  guard = std::make_unique<tissue::StateGuard>(tissue_model);
  const Input home = CalcScriptInput(*scene, 0.0);
  camera_holder.Reset(home.laparoscope);
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
  has_cut = false;
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
    tissue::SolverOptions options;
    options.threads = threads;
    if (scene->operation) options.spare_share = 0.5;  // cuts go on in the same memory
    solver = std::make_unique<tissue::EquilibriumSolver>(tissue_model, options);
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
    const double volume_change = tissue::FillToPressure(*solver, organ, internal_pressure[organ], {},
                                                        *conservation, tissue_at_start, conserved_at_start);
    if (!(volume_change < kFilledTolerance)) {
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
    c.NoteActs();
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
  exact.max_outer_iterations = 50;
  tissue::EquilibriumSolver judge(c.tissue_model, 1);
  const tissue::SolveReport solved =
      tissue::FindConservedEquilibrium(judge, exact, *c.conservation, c.load, state, c.conserved);
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
  if (c.settings.holds_camera) {
    for (const double joint : {c.laparoscope.pan, c.laparoscope.tilt, c.laparoscope.depth}) hash.Add(joint);
  }
  c.touch.AddTo(hash);
  if (c.operation != nullptr) c.operation->AddTo(hash);
  c.rigid.AddTo(hash);
  c.monitor.AddTo(c.snapshot.task, hash);
  return hash.Value();
}

}  // namespace trocar::session
