// SPDX-License-Identifier: Apache-2.0
/// \file simulation_content.h  What a simulation is made of, and the stages of its tick.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera_holder.h"
#include "operation/operation.h"
#include "patient_tissue.h"
#include "rigid_stage.h"
#include "task_monitor.h"
#include "tool_contacts.h"
#include "trocar/session/simulation.h"
#include "trocar/surgery/grasp.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/state_guard.h"
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

namespace trocar::session {

/// Gravity in which the organs were imaged: the body lay on its back [m/s^2].
inline constexpr Vec3 kImagingGravity{0, 0, -9.81};

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
  std::uint64_t tick = 0;
  tissue::TissueState tissue;
  tissue::ConservationState conserved;
  std::array<instrument::TrocarJoints, kHandCount> joints;
  ToolContacts touch;
  std::array<surgery::Grasp, kHandCount> grasps;
  std::unique_ptr<tissue::StateGuard> guard;
  RigidStage rigid;
  TaskMonitor monitor;
  CameraHolder camera_holder;
  instrument::TrocarJoints laparoscope;

  // scratch
  std::unique_ptr<tissue::EquilibriumSolver> solver;
  const tissue_cuda::GpuOrCpuSolver* gpu_solver = nullptr;  // the same, where the GPU was asked for
  std::unique_ptr<tissue::Conservation> conservation;
  LiveSettings settings;
  tissue::TissueLoad load;
  tissue::SolveReport report;
  tissue::ConservationTick good_conserved;              // after the last good tick
  std::vector<tissue::NodeCondition> solved_condition;  // a grasp may slip once the forces are known
  bool has_cut = false;                                 // since the last solve
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
  void MoveLaparoscope(const Input& input) noexcept;
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
  void NoteActs() noexcept;
  void ChangeTopology();
  void FollowTopology();
};

}  // namespace trocar::session
