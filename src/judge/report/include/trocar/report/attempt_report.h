// SPDX-License-Identifier: Apache-2.0
/// \file attempt_report.h  Report that a person reads after an attempt, as plain values; document.h writes it.
///
/// Training feedback, not certified assessment.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/report/document.h"
#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_definition.h"
#include "trocar/training/metric_value.h"

namespace trocar::record {
struct Description;
}

namespace trocar::report {

/// Facts of an attempt that the trace does not know: who made it, and at what task.
struct AttemptFacts {
  std::string person;    ///< pseudonym; empty: nobody in particular
  std::string task;      ///< for a person: "Object transport"
  std::string task_key;  ///< "object_transport"
  std::string level;     ///< of a task; may be empty
  std::string patient;   ///< may be empty
  std::uint64_t seed = 0;
  std::string started;    ///< RFC 3339; may be empty
  std::string player;     ///< "expert, seed 3", "mouse and keyboard"
  std::string program;    ///< version
  std::string recording;  ///< file name without its folder; may be empty
  /// The score that an able surgeon gets at this level, and nobody more: scene::Task::best_score [%]. Nothing: the score is in
  /// points without a limit.
  std::optional<double> best_score;
  /// Of a recording that was replayed: whether it came to the outcome that its file says. Nothing: it was not read from a file.
  std::optional<bool> is_as_recorded;
};
/// Of a recording. \param task  its name for a person
AttemptFacts DescribeAttempt(const record::Description& description, std::string task);

/// Values of other people for one metric, in its SI unit.
struct MetricReference {
  std::string metric, hand, phase;
  std::optional<double> expert_mean, expert_deviation;
  std::vector<double> group;      ///< values of a group's trainees; may be empty
  std::optional<bool> separates;  ///< novices from experts, as validated; nothing where nobody has looked
};

/// Advice of the coach.
struct Advice {
  std::string sentence, why, exercise, practise;
  std::optional<double> time;  ///< of the moment to look at [s]
};

/// One row of the report, in the unit that is shown.
struct MetricRow {
  std::string id, hand, phase, tool;
  std::string name, about, unit;  ///< for a person
  training::BetterWhen better = training::BetterWhen::kNeither;
  double value = 0;
  double scale = 1;  ///< from SI to the shown unit
  std::optional<double> expert_mean, expert_deviation;
  std::vector<double> group;  ///< ascending
  std::optional<bool> separates;
  training::Evidence evidence =
      training::Evidence::kUnvalidated;  ///< the most that has been shown of the measure
};

struct ErrorRow {
  double time = 0;  ///< [s]
  surgery::Severity severity = surgery::Severity::kMinor;
  int hand = -1;      ///< instrument::Hand, or -1
  std::string what;   ///< a sentence
  std::string where;  ///< organ; may be empty
  double force = 0;   ///< that was the error [N]; 0 where none was
};

struct GoalRow {
  std::string name;
  std::optional<double> time;  ///< [s]
};

/// For the plots: what a hand did, thinned out.
struct HandSeries {
  std::vector<math::Vec2> force;  ///< time [s], [N]
  std::vector<math::Vec2> from_front,
      from_head;  ///< [mm]: to the patient's left and the head; to the left and the front
};

/// The doublet view of the critical view of safety: two sides, each at its own moment.
struct DoubletView {
  std::string front_png, back_png;
  double front_time = 0, back_time = 0;  ///< [s]
  std::string verdict;
};

/// With whom an attempt was compared.
struct GroupFacts {
  std::string name;
  std::size_t people = 0;  ///< whose values stand in MetricRow::group
  std::string why_not;     ///< a sentence where they do not; else empty
};

/// How an attempt came to its end.
enum class Ending : std::uint8_t { kCompleted, kTimeOver, kError, kLeft, kNoTask };

/// "completed", "time_over", "error", "left" or "no_task".
const char* NameOf(Ending ending) noexcept;

struct AttemptReport {
  AttemptFacts facts;
  Ending ending = Ending::kLeft;
  std::string outcome;  ///< a sentence in the language of whoever reads
  bool is_completed = false;
  bool is_operation = false;
  std::optional<double> score;               ///< see AttemptFacts::best_score
  double penalty = 0;                        ///< that errors took off the score, in its unit
  double seconds = 0;                        ///< from the first tick to the last
  std::optional<double> task_seconds;        ///< of a task, from the first movement
  std::optional<double> critical_view_time;  ///< [s]
  std::optional<double> blood_ml, bile_ml;   ///< of an operation
  std::vector<GoalRow> goals;
  std::vector<ErrorRow> errors;  ///< in order of time
  std::vector<training::PhaseSpan> phases;
  std::vector<MetricRow> metrics;  ///< in the order of the definitions
  std::vector<Advice> advice;
  std::optional<GroupFacts> group;
  std::optional<DoubletView> doublet;
  std::vector<Picture> pictures;
  std::string film;  ///< file beside the page; may be empty
  std::vector<std::pair<std::string, std::string>>
      origin;  ///< what else is known of where it comes from; may be empty
  std::array<HandSeries, 2> hands;
};

/// The time of an attempt that a person is told everywhere: of a task from the first movement, else from the first tick [s].
inline double ShownSeconds(const AttemptReport& report) {
  return report.task_seconds.value_or(report.seconds);
}

struct AttemptReportInput {
  AttemptFacts facts;
  std::span<const MetricReference> references;
  std::span<const Advice> advice;
};

/// Without pictures, which the caller adds.
AttemptReport MakeAttemptReport(const training::AttemptTrace& trace, const training::AttemptMetrics& metrics,
                                const AttemptReportInput& input);

Document MakeDocument(const AttemptReport& report);

// --- words

/// "1:07", "2:03:09"
std::string FormatClock(double seconds);
/// So many significant digits, with the decimal mark of the chosen language.
std::string FormatDigits(double value, int digits = 4);
/// "67 s", "12 min 7 s"
std::string FormatDuration(double seconds);
/// Number with as many digits as a reader needs.
std::string FormatShown(double value);
/// "24 November 2026, 22:50" of RFC 3339; as it is where it is none.
std::string FormatDate(const std::string& date);
/// "Dissection of the hepatocystic triangle" of "CalotTriangleDissection"; as it is where it is unknown.
std::string PhaseName(const std::string& phase);
/// "left hand", "right hand", "camera" or empty.
std::string HandName(const std::string& hand);

}  // namespace trocar::report
