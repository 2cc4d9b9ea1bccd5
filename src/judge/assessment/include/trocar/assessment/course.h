// SPDX-License-Identifier: Apache-2.0
/// \file course.h  A course: steps of tasks and operations, each with a goal, words before and after, and what passes it; and how
/// far somebody is in it. A course is a JSON file that a surgeon can write: docs/courses.md, schemas/course.schema.json.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/assessment/attempt.h"
#include "trocar/assessment/milestone.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/base/result.h"

namespace trocar::assessment {

/// Choice of the patient: the scene's own, one from a folder, or a generated one.
struct PatientChoice {
  std::filesystem::path folder;                     ///< empty: not from a folder
  std::optional<std::uint64_t> seed;                ///< of a generated one
  std::vector<anatomy::ParameterSetting> settings;  ///< in place of drawn values
  /// "seed 7, moynihan_hump=yes"; empty for the scene's own
  std::string Text() const;
};

struct Step {
  std::string key, name;
  std::string goal;                                                   ///< one sentence
  std::string briefing;                                               ///< before the attempt
  std::string after_pass, after_fail;                                 ///< debriefing
  std::string task, level;                                            ///< a task with its level, or ...
  std::string operation;                                              ///< ... an operation
  PatientChoice patient;                                              ///< of an operation
  Milestone from = Milestone::kStart, until = Milestone::kCompleted;  ///< of an operation
  std::optional<std::uint64_t> seed;       ///< of the task; nothing: every attempt has its own
  Proficiency proficiency;                 ///< without a threshold, completing passes
  std::size_t consecutive_passes = 2;      ///< in a row, once, >= 1
  std::size_t passes = 2;                  ///< in all, >= consecutive_passes
  std::vector<std::string> prerequisites;  ///< keys of steps that have to be done before
  std::optional<int> due_days;             ///< after the course's start

  bool IsOperation() const { return !operation.empty(); }
};

struct Course {
  std::string key;  ///< file name without its ending
  std::filesystem::path path;
  std::string name, about;
  std::vector<Step> steps;  ///< at least one
  /// \return nullptr where there is none
  const Step* Find(std::string_view step) const;
};

/// \return the file's error; kCourseInvalid with file, JSON path and remedy where a step names a task, level, patient, threshold or
/// step that there is not, or contradicts itself
base::Result<Course> ReadCourse(const std::filesystem::path& path);
/// Courses that are delivered with the program, by key.
base::Result<std::vector<Course>> ListCourses();
/// A file as it is, or the key of a delivered one. \return kUnknownName with those known
base::Result<Course> FindCourse(const std::string& name_or_path);
/// \return kUnknownName with the steps known
base::Result<Step> FindStep(const Course& course, const std::string& key);

/// Whether an attempt is one at this step: named for it, or of the same task, level, patient and part.
bool IsAttemptAt(const Course& course, const Step& step, const Attempt& attempt);

enum class StepState { kLocked, kOpen, kDone };
/// "locked", "open", "done"
std::string_view NameOf(StepState state) noexcept;

struct StepProgress {
  std::string key;
  StepState state = StepState::kLocked;
  std::size_t attempts = 0, passes = 0;  ///< made while it was not locked
  std::size_t longest_run = 0;           ///< of passes in a row
  std::vector<std::string> locked_by;    ///< prerequisites that are not done
  std::optional<std::chrono::sys_days> due;
  bool is_overdue = false;
};

struct CourseProgress {
  std::vector<StepProgress> steps;  ///< (Course::steps)
  std::optional<std::size_t> next;  ///< the open step that is due first; without dates the first that is open
  bool IsDone() const { return !next.has_value(); }
};

struct CourseDates {
  std::optional<std::chrono::sys_days> started, today;
};

/// \param attempts  in the order in which they were made; those at a step that was locked do not count for it
CourseProgress CalcProgress(const Course& course, std::span<const Attempt> attempts,
                            const CourseDates& dates = {});

/// "2026-11-25". \return nothing where it is no day
std::optional<std::chrono::sys_days> ParseDay(std::string_view text);
std::string FormatDay(std::chrono::sys_days day);

}  // namespace trocar::assessment
