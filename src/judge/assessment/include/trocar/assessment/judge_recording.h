// SPDX-License-Identifier: Apache-2.0
/// \file judge_recording.h  From a recording to an attempt with its metrics, by computing it again.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "trocar/assessment/attempt.h"
#include "trocar/assessment/attempt_fold.h"
#include "trocar/assessment/course.h"
#include "trocar/base/result.h"
#include "trocar/record/recording.h"
#include "trocar/record/replay.h"

namespace trocar::assessment {

struct ReplaySettings {
  int threads = 1;  ///< of the solver; the bits are the same for any number
  /// Told the share done, 0 to 1; false gives up. May be empty.
  std::function<bool(double share)> progress;
};

/// "peg_transfer" of a recording's "peg_transfer" or "/data/scenes/tasks/peg_transfer.json".
std::string TaskKeyOf(const std::string& name);

/// Plays a replay from where it stands to its end, or to the moment at which a part of an operation ends.
/// \param from, until  the part; kCompleted: to the end
/// \return kRecordingInvalid where it does not replay, kCancelled where `progress` gave up, the metrics' error
base::Result<PlayedAttempt> PlayAttempt(record::Replay& replay, Milestone from, Milestone until,
                                        const ReplaySettings& settings = {});
/// As above, with what has been taken in already: after kCancelled the same replay and fold go on where they stopped.
/// \param fold  made where the replay began
base::Result<PlayedAttempt> PlayAttempt(record::Replay& replay, AttemptFold& fold,
                                        const ReplaySettings& settings = {});

/// The whole recording as an attempt.
/// \return the error of the replay or of PlayAttempt
base::Result<Attempt> MakeAttempt(record::Recording recording, const ReplaySettings& settings = {});

/// As above, for a step of a course: its operation is judged until the step's last moment; what comes after it in the recording
/// does not count.
/// \return kCourseInvalid where the recording is of another task, level, operation or patient, or begins at another moment
base::Result<Attempt> MakeAttempt(record::Recording recording, const Course& course, const Step& step,
                                  const std::filesystem::path& cache = {},
                                  const ReplaySettings& settings = {});

}  // namespace trocar::assessment
