// SPDX-License-Identifier: Apache-2.0
/// \file task.h  Task of a trainee in a scene, as data: goals, errors and points over a small vocabulary.
/// Nothing here knows a particular task; docs/tasks.md shows how one is written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/hand.h"
#include "trocar/math/vector.h"
#include "trocar/surgery/error_log.h"

namespace trocar::scene {

/// How a region is shown to the trainee.
enum class RegionMark : std::uint8_t {
  kNone,
  kRing,
  kCage,
  kBall,
  kBand  ///< a ring round the duct or vessel that passes through the region, moving with it
};

/// Part of space: a ball or a box.
struct Region {
  std::string name;
  math::Vec3 centre;                 ///< world frame [m]
  double radius = 0;                 ///< [m]; 0 for a box
  math::Vec3 half;                   ///< of a box, along the axes of the world [m]
  std::optional<math::Vec3> facing;  ///< from where it is to be looked at: unit vector out of it
  RegionMark mark = RegionMark::kNone;

  bool Contains(const math::Vec3& p_world) const noexcept;
};

/// The vocabulary. Every word is true or false in a tick, for one object or one hand.
enum class ConditionKind : std::uint8_t {
  kHeld,          ///< "held": `object` is in the jaws of `hand`
  kLifted,        ///< "lifted": `object` is held, `amount` [m] above where it was at the start
  kHandedOver,    ///< "handed_over": `hand` let go of `object` that both held in the air, and `to` has it
  kInRegion,      ///< "in_region": `object`'s origin is in one of `regions`
  kPlaced,        ///< "placed": as in_region, let go and at rest
  kTipInRegion,   ///< "tip_in_region": the tip of `hand`'s tool
  kCameraSees,    ///< "camera_sees": region within `angle` of the picture's middle, `near` to `far` away,
                  ///< and seen from its facing side within `facing_angle`
  kTouches,       ///< "touches": `object` touches `other`
  kToolTouches,   ///< "tool_touches": the tool of `hand` touches `object`, with `amount` [N] on it or more
  kDropped,       ///< "dropped": `object` was let go in the air and has fallen `amount` [m]
  kOutside,       ///< "outside": `object` is in none of `regions`
  kOutOfView,     ///< "out_of_view": `object` is out of the laparoscope's picture
  kTipOutOfView,  ///< "tip_out_of_view": the tip of `hand`'s tool is
  kForceAbove,    ///< "force_above": on the tool of `hand`, `amount` [N]
  kEvent,  ///< "event": the simulation said `event`, of `hand` or of any, in `regions` or outside of them
  kOperationError,  ///< "operation_error": surgery's own judge found `error`, of `hand` or of any
  kClipped,         ///< "clipped": a clip holds the whole of a duct in one of `regions`, and crosses no other
  kDivided,         ///< "divided": a duct has been cut through in one of `regions`
  kUnclippedCut,  ///< "unclipped_cut": a duct was cut through with fewer than `amount` such clips in the scene
  kParted,        ///< "parted": `band` has been divided
  kCutFree,       ///< "cut_free": what the circle on `sheet` encloses hangs on the border no more
  kCutOffLine,    ///< "cut_off_line": a cut in `sheet` is `amount` [m] from its circle, or farther
  kCutAreaOff,  ///< "cut_area_off": between circle and rim of the piece that came free lies `amount` [m^2], or more
  kCount
};
/// "held", "lifted", ... as above.
std::string_view ConditionName(ConditionKind kind) noexcept;

/// Any hand, in Condition::hand.
inline constexpr int kAnyHand = -1;

struct Condition {
  ConditionKind kind = ConditionKind::kHeld;
  int object = -1, other = -1;  ///< Scene::objects
  int hand = kAnyHand, to = kAnyHand;
  std::vector<int> regions;  ///< Task::regions
  bool is_outside = false;   ///< of kEvent: counts outside of them
  double seconds = 0;        ///< for which it must hold without a break [s]
  double amount = 0;
  double angle = 0, facing_angle = 0;  ///< [rad]
  double near = 0, far = 0;            ///< [m]
  bool while_held = false;             ///< counts only while a hand holds `object`
  int event = -1;                      ///< surgery::FactKind
  int error = -1;                      ///< row of Procedure::errors
  int band = -1;                       ///< ModelSetup::bands
  int sheet = -1;                      ///< ModelSetup::sheets
};

/// Steps that have to be done one after the other.
struct Goal {
  std::string name;
  std::vector<Condition> steps;
  double points = 0;
  int stage = 0;  ///< counts only when every goal of a lower stage is done
};

/// Error rule of a task. Counts each time that one of its conditions begins to hold.
struct ErrorRule {
  std::string name;   ///< key: "wire_touched"
  std::string about;  ///< for the trainee: "The ring touched the wire"
  surgery::Severity severity = surgery::Severity::kMinor;
  std::vector<Condition> when;  ///< any of these
  double penalty = 0;           ///< points, each time
  bool ends_task = false;
};

struct Task {
  std::string name, about;
  std::string level = "normal";
  std::vector<Region> regions;
  std::vector<Goal> goals;  ///< at least one
  std::vector<ErrorRule> errors;
  double time_limit = std::numeric_limits<double>::infinity();  ///< [s] from the first movement
  double points_per_second_left = 0;
  double reference_points = 0;  ///< of an able surgeon: TaskSnapshot::score is 100 for these; 0: in points
  double best_score = 100;      ///< what a person is shown for the reference's points, or more, at this level
  /// The way of each hand's tip in straight lines, from where it starts [m], world frame; empty where a hand has none.
  std::array<std::vector<math::Vec3>, instrument::kHandCount> ideal_path;
};

/// Length of a hand's ideal path [m]; 0 where it has none.
/// \param hand  < instrument::kHandCount
double CalcIdealPathLength(const Task& task, std::size_t hand) noexcept;

enum class TaskPhase : std::uint8_t { kNone, kReady, kRunning, kCompleted, kTimeOver, kEnded };
/// "none", "ready", "running", "completed", "time_over", "ended"
std::string_view PhaseName(TaskPhase phase) noexcept;

struct GoalSnapshot {
  std::uint32_t steps_done = 0;
  bool is_done = false;
  bool is_open = false;     ///< may be worked on now
  double held_seconds = 0;  ///< of the present step, where it has to hold for a time
};

/// One error as it happened.
struct TaskError {
  std::int32_t rule = -1;    ///< Task::errors
  double time = 0;           ///< since the first movement [s]
  math::Vec3 position;       ///< of the object or the tool's tip, world frame [m]
  std::int32_t object = -1;  ///< Scene::objects, or -1
  std::int32_t hand = -1;    ///< whose tool, or -1
};

/// How a task goes. Sizes stay while a scene runs.
struct TaskSnapshot {
  TaskPhase phase = TaskPhase::kNone;
  double time = 0;                    ///< since the first movement, until the end [s]
  std::vector<GoalSnapshot> goals;    ///< (Task::goals)
  std::vector<std::uint32_t> errors;  ///< (Task::errors) how often
  double penalty = 0;                 ///< points lost so far
  double score = 0;  ///< points, or per cent of the reference, without a limit; CalcShownScore is for people
  std::uint64_t error_count = 0;            ///< the newest are in `last_errors`
  std::array<TaskError, 16> last_errors{};  ///< ring: error n at n % 16

  bool IsOver() const { return phase >= TaskPhase::kCompleted; }
};

/// The score that a person is shown: from 0 to Task::best_score, which the reference's points reach and more points do not
/// exceed; without a reference, points. What the state holds is not changed by it.
double CalcShownScore(const Task& task, const TaskSnapshot& now) noexcept;

void VisitState(base::StateArchive& archive, GoalSnapshot& goal);
void VisitState(base::StateArchive& archive, TaskError& error);
void VisitState(base::StateArchive& archive, TaskSnapshot& task);

}  // namespace trocar::scene
