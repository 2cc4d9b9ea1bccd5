// SPDX-License-Identifier: Apache-2.0
/// \file simulation_content.h  Content of a simulation: its state, its scratch, and the stages of its tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "camera_holder.h"
#include "operation/operation.h"
#include "rigid_stage.h"
#include "simulation_model.h"
#include "task_monitor.h"
#include "tool_contacts.h"
#include "topology.h"
#include "trocar/simulation/simulation.h"
#include "trocar/surgery/fact.h"
#include "trocar/surgery/grasp.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/state_guard.h"

namespace trocar::simulation {

/// All that decides how the world goes on. The classes hold constants and scratch of their own beside it; what each
/// lists in VisitState is the state.
struct WorldState {
  std::uint64_t tick = 0;
  Topology topology;
  tissue::TissueState tissue;
  tissue::ConservationState conserved;
  tissue::ConservationTick good_conserved;  ///< after the last good tick
  std::optional<tissue::StateGuard> guard;
  std::array<instrument::TrocarJoints, instrument::kHandCount> joints;
  std::array<surgery::Grasp, instrument::kHandCount> grasps;
  std::array<math::Vec3, instrument::kHandCount> forces;  ///< on the tools, world frame [N]
  ToolContacts touch;
  RigidStage rigid;
  std::unique_ptr<Operation> operation;  ///< where the scene is one
  CameraHolder camera_holder;
  instrument::TrocarJoints laparoscope;  ///< where it is held
};

/// State of the observers, which only look: the judge of the procedure, the monitor of the task, and the events.
struct JudgementState {
  std::unique_ptr<scene::ProcedureJudge> procedure;  ///< where the scene is an operation that somebody judges
  TaskMonitor monitor;
  scene::TaskSnapshot task;
  std::array<scene::Event, kEventRing> events{};
  std::uint64_t event_count = 0;
  bool was_frozen = false, were_tools_touching = false;
};

/// Data that the stages of one tick pass on. None of it decides the next tick.
struct TickScratch {
  scene::LiveSettings settings;
  math::Vec3 gravity;  ///< in the patient's frame [m/s^2]
  tissue::TissueLoad load;
  tissue::SolveReport report;
  std::vector<tissue::NodeCondition> solved_condition;  ///< a grasp may slip once the forces are known
  bool has_cut = false;                                 ///< before the solve
  std::array<bool, instrument::kHandCount> was_exchange_refused{};
  std::array<surgery::GraspChange, instrument::kHandCount> changes{};
  std::array<std::int32_t, instrument::kHandCount> changed_organs{};
  std::array<std::int32_t, instrument::kHandCount> touched_organs{-1, -1};
  tissue::GuardVerdict verdict = tissue::GuardVerdict::kGood;
  std::array<std::uint32_t, 8> torn{};  ///< lowest of the strands that tore in this tick
  std::size_t torn_count = 0;
  std::vector<std::uint32_t> torn_springs;  ///< (springs) those of the walls that tore in this tick, first
  std::size_t torn_spring_count = 0;
  HandsNow hands;
  surgery::FactList facts;
  std::array<double, kStageCount> stage_seconds{};
};

struct Simulation::Content {
  std::shared_ptr<const SimulationModel> model;
  WorldState world;
  JudgementState judgement;

  // scratch
  TickScratch tick;
  std::unique_ptr<tissue::EquilibriumSolver> solver;
  const tissue::DeviceSolver* device_solver = nullptr;  // the same, where another device was asked for
  Services services;
  std::unique_ptr<tissue::Conservation> conservation;
  surgery::GraspSettings grasp_settings;
  Snapshot snapshot;
  std::unique_ptr<tissue::PatchCutter> patch_cutter;

  const scene::Scene& GetScene() const noexcept { return *model->scene; }
  const instrument::Tool& ToolOf(int hand) const noexcept {
    return world.operation != nullptr ? world.operation->Tool(hand) : GetScene().instruments[hand].tool;
  }
  ToolsNow GetTools() const noexcept;
  OperatedTissue GetTissue() noexcept;
  instrument::Camera GetCamera() const noexcept;

  // --- the stages of a tick, in their order (docs/step.md)
  /// Up to the laparoscope. \param is_judged  a judge looks on
  void StepWorld(const scene::Input& input, bool is_judged) noexcept;
  void ReadInputs(const scene::Input& input) noexcept;
  void MoveTools(const scene::Input& input) noexcept;
  void FindContacts() noexcept;
  void UseTools(const scene::Input& input) noexcept;
  void Heat() noexcept;
  void WitnessTools() noexcept;
  void Assist() noexcept;
  void CutTopology() noexcept;
  void SolveTissue() noexcept;
  void GuardTissue() noexcept;
  void PlaceTools() noexcept;
  void StepRigidBodies() noexcept;
  void Flow() noexcept;
  void MoveLoose() noexcept;
  void HoldCamera() noexcept;
  void Judge() noexcept;
  void Publish() noexcept;
  void JudgeTask() noexcept;

  // --- parts of them
  void MoveCamera(const scene::Input& input) noexcept;
  void Grasp() noexcept;
  void MarkPressedNodes() noexcept;
  void TearTissue() noexcept;
  void Emit(surgery::FactKind kind, int hand, std::int32_t organ, double force,
            std::int32_t object = -1) noexcept;
  void EmitGrasps() noexcept;
  scene::Event& Remember(const scene::Event& event) noexcept;
  void RememberFacts(std::span<const surgery::Fact> facts) noexcept;

  // --- as a whole
  base::Status MakeParts();
  void RegisterTopology();
  void UpdateSurfaces(bool is_restored);
  void MakeSolver();
  void Begin();
  void VisitWorld(base::StateArchive& archive);
  void VisitJudgement(base::StateArchive& archive);
  void VisitState(base::StateArchive& archive);
  // only reads, though the list of fields is the one that restores
  void Save(std::vector<std::byte>& bytes, const AlterField& alter = {});
  base::Status Restore(base::StateArchive& archive);
};

}  // namespace trocar::simulation
