// SPDX-License-Identifier: Apache-2.0
/// \file judge_recording.h  From a recording to an attempt with its metrics, by computing it again.
#pragma once

#include <filesystem>
#include <functional>

#include "trocar/assessment/attempt.h"
#include "trocar/assessment/course.h"
#include "trocar/core/result.h"
#include "trocar/record/recording.h"

namespace trocar::assessment {

struct ReplaySettings {
  int threads = 1;                             ///< of the solver; the bits are the same for any number
  std::function<void(double share)> progress;  ///< 0 to 1; may be empty
};

/// The whole recording as an attempt.
/// \return the error of the replay or of the metrics
core::Result<Attempt> MakeAttempt(record::Recording recording, const ReplaySettings& settings = {});

/// The same for a step of a course: its operation is judged until the step's last moment, and what comes after it in the recording
/// does not count.
/// \return kCourseInvalid where the recording is of another task, level, operation or patient, or begins at another moment
core::Result<Attempt> MakeAttempt(record::Recording recording, const Course& course, const Step& step,
                                  const std::filesystem::path& cache = {},
                                  const ReplaySettings& settings = {});

}  // namespace trocar::assessment
