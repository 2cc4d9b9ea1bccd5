// SPDX-License-Identifier: Apache-2.0
/// \file judged_attempt.h  From a recording to all that can be said of it: metrics, verdict, the coach's words, a report.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "trocar/assessment/attempt_fold.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/base/result.h"
#include "trocar/record/outcome.h"
#include "trocar/record/replay.h"
#include "trocar/report/attempt_report.h"
#include "trocar/store/attempts.h"

namespace trocar::centre {

using StepName = record::CourseStep;

struct JudgeSettings {
  int threads = 1;     ///< of the solver; the numbers are the same for any number
  StepName step;       ///< what it was made for
  std::string person;  ///< pseudonym; may be empty
  /// Told the share done, 0 to 1; false gives up. May be empty.
  std::function<bool(double)> progress;
};

struct JudgedAttempt {
  store::Attempt attempt;  ///< with metrics, as the store keeps it
  report::AttemptReport report;
  std::optional<assessment::Verdict> verdict;  ///< nothing where there are no thresholds
  std::string debriefing;                      ///< of the step; empty without one
  StepName step;
  double begin = 0;               ///< of the recording: where a replay of it begins [s]
  bool is_demonstration = false;  ///< of the script or the expert in the window: nobody's own
};

/// A recording that is being played again, to be judged: what was given up goes on where it stopped.
struct Replaying {
  record::Replay replay;
  assessment::AttemptFold fold;
};

/// Plays the recording again and judges it, until the step's last moment where it is of a part of an operation.
/// \param[in,out] going_on  nothing, or where an earlier call was given up; where this one is, it is set
/// \return the recording's error, kRecordingInvalid where it does not replay; kCancelled where `progress` gave up
/// \note Takes about as long as the attempt took, or less.
base::Result<JudgedAttempt> JudgeRecording(const std::filesystem::path& path, const JudgeSettings& settings,
                                           std::unique_ptr<Replaying>* going_on = nullptr);

/// Judges an attempt that this program has measured while it was played. All numbers are those of JudgeRecording.
/// \param path  of its recording, which is whole
base::Result<JudgedAttempt> JudgePlayed(const std::filesystem::path& path,
                                        const assessment::AttemptFold& fold, const JudgeSettings& settings);

/// Attempt as far as it is known without playing the recording again: no metrics, no verdict.
base::Result<store::Attempt> DescribeRecording(const std::filesystem::path& path, const std::string& person,
                                               const StepName& step);

/// The step for which an attempt of the store was made.
StepName FindStepName(const store::Attempt& attempt);

/// "Peg transfer" of "peg_transfer"; the key's words where no task has it.
std::string TaskNameOf(const std::string& key);

}  // namespace trocar::centre
