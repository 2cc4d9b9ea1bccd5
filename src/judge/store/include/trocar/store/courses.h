// SPDX-License-Identifier: Apache-2.0
/// \file courses.h  Courses as they were written, who shall do them by when, and thresholds of passing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/store/attempts.h"

namespace trocar::store {

struct CourseStep {
  std::string key;
  std::string task, level;
};

/// A version of a course never changes once it is stored: what somebody passed stays what it was.
struct Course {
  std::string key;
  int version = 1;
  std::string text;  ///< the course's file, JSON
  std::vector<CourseStep> steps;
};

/// Again with the same text does nothing.
/// \return kStoreInvalid where the version is there with another text, or the course has no step, or a step twice
base::Status AddCourse(Store& store, const Viewer& viewer, const Course& course);
/// \param version  0: the newest
base::Result<Course> FindCourse(Store& store, std::string_view key, int version = 0);
/// The newest version of each, without text and steps.
base::Result<std::vector<Course>> ListCourses(Store& store);

struct StepDue {
  std::string step;
  std::int64_t due_ms = 0;
};

struct Assignment {
  std::string course;
  int version = 0;
  std::string trainee, group;          ///< one of the two
  std::optional<std::int64_t> due_ms;  ///< of the whole course [ms since 1970 UTC]
  std::vector<StepDue> step_due;
};
/// Once more for the same course and trainee or group replaces the dates.
/// \return kStoreUnknown; kStoreInvalid where a date is of a step that the course has not
base::Status AddAssignment(Store& store, const Viewer& viewer, const Assignment& assignment);
/// Assignments of a trainee, to them or to their groups; the one that is due first comes first.
base::Result<std::vector<Assignment>> ListAssignments(Store& store, const Viewer& viewer,
                                                      std::string_view trainee);

/// A level of proficiency, of a site or from the literature.
struct Threshold {
  MetricKey key;
  double value = 0;
  bool more_is_better = false;
  std::string source;
};
/// In place of the one that is there. Attempts that were judged stay judged.
base::Status SetThreshold(Store& store, const Viewer& viewer, const Threshold& threshold);
base::Result<std::vector<Threshold>> ListThresholds(Store& store, std::string_view task,
                                                    std::string_view level);

}  // namespace trocar::store
