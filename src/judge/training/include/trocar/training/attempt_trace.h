// SPDX-License-Identifier: Apache-2.0
/// \file attempt_trace.h  An attempt as plain values: every tool at every tick, what happened, and how it ended. Metrics,
/// reports and coaches are computed from it and from nothing else.
///
/// record::TraceBuilder makes one of a running simulation, record::TraceRecording of a recording. There is no thread tension: no
/// tool of this program holds a thread yet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trocar/instrument/hand.h"
#include "trocar/math/vector.h"
#include "trocar/surgery/error_log.h"

namespace trocar::training {

/// One tool at one tick.
struct ToolSample {
  math::Vec3 tip;             ///< [m], world frame
  math::Vec3 axis{0, 0, -1};  ///< unit vector along the shaft, towards the tip
  double insertion = 0;       ///< depth along the shaft from the trocar [m]
  double spin = 0;            ///< about the shaft [rad]; may wrap
  double jaw = 0;             ///< opening [rad]
  double force = 0;           ///< magnitude on the tool [N], >= 0
  double press =
      0;  ///< how far the hand is pressed into what it touches, past the tool that is seen [m], >= 0
  double duct_distance =
      -1;  ///< of the electrode from the nearest main bile duct's wall while current is on [m]; else -1
  std::int16_t tool = 0;       ///< in use, AttemptTrace::tool_names
  std::int16_t organ = -1;     ///< touched or grasped, AttemptTrace::organ_names; -1 for none
  bool in_view = true;         ///< the tip lies inside the laparoscope's picture
  bool grasping = false;       ///< something is held
  bool in_contact = false;     ///< the tool touches tissue
  bool touching_tool = false;  ///< the other instrument
  bool pedal = false;          ///< a current pedal is pressed, and the tool in use is an electrode
  bool has_current = false;    ///< current flows into tissue
};

/// The laparoscope at one tick.
struct CameraSample {
  math::Vec3 lens;                 ///< [m], world frame
  math::Vec3 direction{0, 0, -1};  ///< unit vector of sight
  double roll = 0;  ///< how far the picture's horizontal leans towards the patient's head [rad]
};

/// Something that happened.
struct AttemptEvent {
  double time = 0;   ///< since the attempt's first tick [s]
  std::string kind;  ///< surgery::FactName, the name of an operation's error, or of a task's rule
  int hand = -1;     ///< instrument::Hand, or -1
  int organ = -1;    ///< AttemptTrace::organ_names, or -1
  double force = 0;  ///< [N], 0 where it means nothing
  std::optional<math::Vec3> position;  ///< world frame [m]
  bool is_error = false;
  surgery::Severity severity = surgery::Severity::kMinor;  ///< of an error
  bool is_rule =
      false;         ///< of an error: a rule of the task was broken, otherwise the operation's judge found it
  std::string text;  ///< for the trainee, a sentence; may be empty
};

/// Above this force a task has an error: twice MetricSettings::force_threshold, and far from what experts need (the greatest force
/// of 400 attempts at object transport by the scripted expert: mean 2.6 N, deviation 0.4 N, assets/validity.json). The next one
/// counts after the force fell below kErrorForceRelease of it.
inline constexpr double kErrorForce = 6.0;  // [N]
inline constexpr double kErrorForceRelease = 0.9;
/// Kind and text of that error; its force is the greatest until it was let go.
inline constexpr const char* kExcessForceOfTask = "excess_force_on_board";
inline constexpr const char* kExcessForceOfTaskText =
    "A tool pressed or pulled far harder than tissue bears.";

/// A fact that went on for a while: the same kind, hand and part in ticks that follow each other.
struct FactSpan {
  std::string kind;  ///< surgery::FactName
  int hand = -1;     ///< instrument::Hand, or -1
  std::string part;  ///< of organ_names; or what a strand is, "bed_strand" for instance; may be empty
  double start = 0, end = 0;  ///< since the attempt's first tick [s], start <= end
  double amount = 0;          ///< see surgery::FactKind: of volumes the sum, else the largest
};

/// Time between two changes of phase. A phase may come again.
struct PhaseSpan {
  std::string name;           ///< "CalotTriangleDissection", as in Cholec80
  double start = 0, end = 0;  ///< since the attempt's first tick [s], start <= end
};

/// A clip, as it was at the end.
struct ClipRecord {
  double time = 0;       ///< when it was closed [s]
  int hand = -1;         ///< instrument::Hand, or -1
  std::string vessel;    ///< organ_names of what it closes; empty for a lost one
  bool is_lost = false;  ///< lies in the abdomen
  bool is_misplaced =
      false;  ///< closed around a part only, or crosses another clip, or on what must stay open
  std::optional<double>
      gap;  ///< to the nearest other clip on the same vessel, straight, as the vessel was at rest [m]
  std::optional<double>
      angle;  ///< between the applier's jaws and the vessel's line when it was closed, 0 to pi/2 [rad]
};

/// Volumes of fluid that have run out since the start.
struct FluidSample {
  double time = 0;             ///< [s]
  double blood = 0, bile = 0;  ///< [m^3]
};

struct GoalRecord {
  std::string name;
  std::optional<double>
      time;  ///< when it was done, since the attempt's first tick [s]; nothing while it is not
  double points = 0;
};

/// How it ended.
struct AttemptOutcome {
  std::string
      phase;  ///< of a task: scene::PhaseName; of an operation "completed" or "unfinished"; else empty
  bool is_completed = false;    ///< the task or the operation was brought to its end
  std::optional<double> score;  ///< of the task, as a person is shown it: scene::CalcShownScore
  double task_time = 0;         ///< of a task, since the first movement [s]
  double penalty = 0;           ///< of a task: points that errors took off its score, in the score's unit
};

/// One attempt. All times count from its first tick; sample k of hands and camera lies at k * dt.
struct AttemptTrace {
  double dt = 0;                         ///< time between ticks [s], > 0
  std::vector<std::string> tool_names;   ///< what a tool in use may be: "grasper", "hook", ...
  std::vector<std::string> organ_names;  ///< organs, then ducts and vessels
  std::array<std::vector<ToolSample>, instrument::kHandCount> hands;  ///< left, right: (ticks) each
  std::vector<CameraSample> camera;                                   ///< (ticks)
  std::vector<AttemptEvent> events;                                   ///< in order of time
  std::vector<FactSpan> facts;      ///< what hands did to tissue, in order of their beginnings
  std::vector<PhaseSpan> phases;    ///< in order, without a gap; empty where the scene is no operation
  std::vector<ClipRecord> clips;    ///< in the order in which they were closed
  std::vector<FluidSample> fluids;  ///< about once a second, the first and the last tick among them
  std::vector<GoalRecord> goals;    ///< of the task, in its order
  int stones_lost = 0;              ///< spilled gallstones that were left behind
  int stones_spilled = 0;           ///< that left their organ through a hole
  std::optional<double> critical_view_time;  ///< when the critical view of safety was first achieved [s]
  bool is_operation = false;  ///< a patient is operated on: errors, phases and fluids are judged
  AttemptOutcome outcome;
  /// Of the task: how far each hand's tip would go in straight lines [m], > 0; nothing where the task says nothing.
  std::array<std::optional<double>, instrument::kHandCount> ideal_path;

  std::size_t Ticks() const { return hands[0].size(); }
  /// From the first tick to the last [s].
  double Seconds() const { return Ticks() > 1 ? static_cast<double>(Ticks() - 1) * dt : 0.0; }
};

}  // namespace trocar::training
