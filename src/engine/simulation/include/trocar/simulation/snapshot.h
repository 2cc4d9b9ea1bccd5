// SPDX-License-Identifier: Apache-2.0
/// \file snapshot.h  Snapshot that a tick publishes: read-only, complete for drawing, read-outs and metrics.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/camera.h"
#include "trocar/math/pose.h"
#include "trocar/scene/event.h"
#include "trocar/scene/input.h"
#include "trocar/scene/scene_object.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/operation_snapshot.h"
#include "trocar/surgery/fact.h"
#include "trocar/surgery/neighbour_contact.h"

namespace trocar::simulation {

/// One instrument after a tick.
struct InstrumentSnapshot {
  math::Pose
      X_world_tool;  ///< of the tool that is seen: stays outside of the tissue; frame of instrument/tool.h
  instrument::TrocarJoints joints;  ///< of the hand, after limits
  math::Vec3 force;                 ///< of tissue and the other tool on the tool, world frame [N]
  bool is_grasping = false;
  bool is_touching = false;
  /// Index into Simulation::Surfaces() of what is grasped or touched (Patient::organs first, then its tubes), or
  /// -1.
  std::int32_t organ = -1;
  math::Pose X_world_device;      ///< where the hand is: may lie in the tissue that it presses
  double pinch = 0;               ///< of the jaws on what they hold [N]
  double overlap = 0;             ///< of the tool that is seen with tissue, what is left of it [m]
  bool is_touching_tool = false;  ///< the other instrument
  std::int32_t object = -1;       ///< Scene::objects that it holds, or -1
};

/// Volume of one organ after a tick.
struct OrganSnapshot {
  double volume = 0;    ///< enclosed by its surface [m^3]
  double target = 0;    ///< of what is inside: kept, or let out through a hole [m^3]
  double pressure = 0;  ///< inside above outside [Pa]
  double leaked = 0;    ///< since the start [m^3]
};

/// Stages of the tick, in order; docs/step.md says what each reads and changes.
enum class Stage {
  kReadInputs,
  kMoveTools,
  kFindContacts,
  kUseTools,
  kHeat,
  kWitness,
  kAssistant,
  kTopology,
  kTissue,
  kGuard,
  kPlaceTools,
  kRigidBodies,
  kFlow,
  kLooseBodies,
  kCamera,
  kJudgement,
  kPublish,
  kTaskRules,
  kCount
};
/// "read_inputs", "move_tools", ...
std::string_view StageName(Stage stage) noexcept;
inline constexpr int kStageCount = static_cast<int>(Stage::kCount);

/// Most facts of a tick in a scene that is no operation.
inline constexpr std::size_t kMostPlainFacts = 16;
/// How many of the newest events a snapshot holds.
inline constexpr std::size_t kEventRing = 8;

/// Copying into one that has been used before does not allocate (the sizes never change while a scene runs).
struct Snapshot {
  std::uint64_t tick = 0;
  double time = 0;  ///< tick * tick_seconds [s]
  /// (nodes) organ after organ as in Patient::organs, then the centre-line nodes of tube after tube [m]
  std::vector<math::Vec3> positions;
  std::array<InstrumentSnapshot, instrument::kHandCount> instruments;
  std::vector<OrganSnapshot> organs;  ///< (organs) as in Patient::organs
  OperationSnapshot operation;
  std::vector<scene::ObjectSnapshot> objects;  ///< (Scene::objects)
  scene::TaskSnapshot task;
  std::array<surgery::Dent, surgery::kDentCount> dents;  ///< that tools have pressed into Patient::neighbours
  instrument::TrocarJoints laparoscope;                  ///< after limits
  math::Pose X_world_laparoscope;    ///< origin at the lens, looking along -z, +y up in the picture
  double residual = 0;               ///< largest node residual, relative: see tissue/solver_settings.h [-]
  int iterations = 0;                ///< of the solver in this tick
  std::size_t contacts = 0;          ///< contact springs of this tick
  std::size_t dropped_contacts = 0;  ///< beyond the capacity
  math::Vec3 gravity;                ///< world frame [m/s^2]
  std::array<double, kStageCount> stage_seconds{};  ///< wall time of each stage of the last tick
  double tick_seconds = 0;                          ///< sum of the stages [s]
  std::vector<surgery::Fact> facts;                 ///< of the last tick: the first fact_count count
  std::size_t fact_count = 0;
  std::uint64_t event_count = 0;                  ///< since the start; the newest are in `events`
  std::array<scene::Event, kEventRing> events{};  ///< ring: event n at n % kEventRing
};

}  // namespace trocar::simulation
