// SPDX-License-Identifier: Apache-2.0
/// \file snapshot.h  What a tick publishes: read-only, complete for drawing, read-outs and metrics.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "trocar/math/pose.h"
#include "trocar/session/input.h"

namespace trocar::session {

using math::Pose;
using math::Vec3;

/// One instrument after a tick.
struct InstrumentSnapshot {
  Pose X_world_tool;                ///< tool frame of instrument/tool.h
  instrument::TrocarJoints joints;  ///< after limits
  Vec3 force;                       ///< of the tissue on the tool, world frame [N]
  bool is_grasping = false;
  bool is_touching = false;
  std::int32_t organ = -1;  ///< index into Patient::organs of what is grasped or touched, or -1
};

/// Volume of one organ after a tick.
struct OrganSnapshot {
  double volume = 0;    ///< enclosed by its surface [m^3]
  double target = 0;    ///< of what is inside: kept, or let out through a hole [m^3]
  double pressure = 0;  ///< inside above outside [Pa]
  double leaked = 0;    ///< since the start [m^3]
};

/// Stages of the tick, in order.
enum class Stage {
  kReadInputs,
  kMoveInstruments,
  kFindContacts,
  kActOnTissue,
  kSolve,
  kCheckState,
  kUpdateHierarchy,
  kDetectEvents,
  kPublish,
  kCount
};
/// "read_inputs", "move_instruments", ...
std::string_view StageName(Stage stage) noexcept;
inline constexpr int kStageCount = static_cast<int>(Stage::kCount);

enum class EventKind { kGrasp, kRelease, kSlip, kGraspMissed, kStateRestored, kOrganFrozen, kTear };
/// "grasp", "release", "slip", "grasp_missed", "state_restored", "organ_frozen", "tear"
std::string_view EventName(EventKind kind) noexcept;

struct Event {
  EventKind kind;
  std::uint64_t tick;
  std::int32_t hand;   ///< Hand, or -1
  std::int32_t organ;  ///< index into Patient::organs, or -1
  double force;        ///< [N], 0 where it means nothing
};

/// Copying into one that has been used before does not allocate (the sizes never change while a scene runs).
struct Snapshot {
  std::uint64_t tick = 0;
  double time = 0;  ///< tick * tick_seconds [s]
  /// (nodes) organ after organ as in Patient::organs, then the centre-line nodes of tube after tube [m]
  std::vector<Vec3> positions;
  std::array<InstrumentSnapshot, kHandCount> instruments;
  std::vector<OrganSnapshot> organs;  ///< (organs) as in Patient::organs
  Pose X_world_laparoscope;           ///< origin at the lens, looking along -z, +y up in the picture
  double residual = 0;                ///< largest node residual, relative: see tissue/solver_settings.h [-]
  int iterations = 0;                 ///< of the solver in this tick
  Vec3 gravity;                       ///< world frame [m/s^2]
  std::array<double, kStageCount> stage_seconds{};  ///< wall time of each stage of the last tick
  double tick_seconds = 0;                          ///< sum of the stages [s]
  std::uint64_t event_count = 0;                    ///< since the start; the newest are in `events`
  std::array<Event, 8> events{};                    ///< ring: event n at n % 8
};

}  // namespace trocar::session
