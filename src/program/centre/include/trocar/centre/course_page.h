// SPDX-License-Identifier: Apache-2.0
/// \file course_page.h  The map of a course: which steps are done, open or locked, and what each asks for.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trocar/assessment/course.h"
#include "trocar/assessment/preparation.h"
#include "trocar/centre/access.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/record/recording.h"

namespace trocar::centre {

/// An exam and who sits it: the certificate is theirs, whoever works at the computer when it is issued.
struct ExamSitting {
  std::filesystem::path file;
  std::string examinee;  ///< pseudonym
};

/// Attempt that the simulator is asked to open.
struct Start {
  record::Description description;  ///< of the scene
  std::filesystem::path
      state;  ///< in the middle of an operation, as assessment::PrepareStep made it; empty: the first tick
  std::string state_surgeon;  ///< who came so far
  /// Of an operation: what of it is done, after which the attempt is over.
  assessment::Milestone from = assessment::Milestone::kStart, until = assessment::Milestone::kCompleted;
  std::string title;                ///< for a person
  StepName step;                    ///< for which it is made
  std::optional<ExamSitting> exam;  ///< without guidance, and once only; nothing: it is no exam
};

struct CoursePage {
  struct Choice {
    std::string key, name;
  };
  struct Step {
    std::string key, name, goal, what, briefing;
    std::string task;       ///< key; empty of an operation
    std::string progress;   ///< "2 of 3 passes, 1 in a row"
    std::string due;        ///< "due 2026-11-30", "overdue since ..."; may be empty
    std::string locked_by;  ///< names; empty where it is not locked
    assessment::StepState state = assessment::StepState::kLocked;
    bool is_overdue = false;
    std::vector<std::string> thresholds;  ///< in words
  };
  std::vector<Choice> courses;
  std::string course;  ///< key of the one that is shown
  std::string name, about, who;
  std::vector<Step> steps;
  std::string next;            ///< key of the step that comes next; empty where the course is done
  std::size_t unverified = 0;  ///< attempts at its tasks that do not count until a replay has verified them
  std::string note;            ///< of them, in words; may be empty
};

/// Where the store is away, the course is shown all the same: nothing is known to be done.
struct LoadedCourse {
  CoursePage page;
  std::optional<base::Error> store_failure;
};
/// \param course  key; empty: the first, or the one that was assigned
/// \return the course's error
base::Result<LoadedCourse> LoadCourse(const Access& access, const std::string& course);

/// Makes what a step needs before it can begin; the scripted expert operates up to its first moment.
/// \param progress  false gives up
base::Result<Start> PrepareStart(const StepName& name,
                                 const std::function<bool(const assessment::PreparationProgress&)>& progress);
/// For a person who waits: "43 %, about 2 min left".
std::string DescribePreparation(const assessment::PreparationProgress& now);

}  // namespace trocar::centre
