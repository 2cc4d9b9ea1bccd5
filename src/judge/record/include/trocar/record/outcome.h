// SPDX-License-Identifier: Apache-2.0
/// \file outcome.h  Outcome of an attempt, computed from the simulation alone: the same for a recording and its replay.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "trocar/simulation/simulation.h"

namespace trocar::record {

/// A JSON object in one line: of a task its phase, time [s], score as shown, goals and errors; of an operation whether it was completed,
/// the critical view, errors, injuries, blood and bile [mL]; of a scene without a task only the time.
/// Equal states give equal texts, digit for digit.
/// \note Allocates.
std::string CalcOutcome(const simulation::Simulation& simulation);

/// Summary of an outcome.
struct OutcomeSummary {
  bool is_completed = false;    ///< as simulation::HasCompleted
  std::optional<double> score;  ///< of a task, as shown
};
/// \param outcome  of CalcOutcome, or what a file says it was
/// \return nothing where it is no such object
std::optional<OutcomeSummary> ReadOutcome(std::string_view outcome);

/// The step of a course for which an attempt is made; both empty: for none.
struct CourseStep {
  std::string course, step;
  bool IsSet() const { return !course.empty(); }
  friend bool operator==(const CourseStep&, const CourseStep&) = default;
};
/// \return the step that an outcome names; none, too, where it cannot be read
CourseStep FindCourseStep(std::string_view outcome);
/// \param outcome  as ReadOutcome takes it; what cannot be read is left out
/// \return the outcome, naming the step
std::string WithCourseStep(std::string_view outcome, const CourseStep& step);

}  // namespace trocar::record
