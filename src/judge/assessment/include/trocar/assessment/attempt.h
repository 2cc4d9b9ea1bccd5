// SPDX-License-Identifier: Apache-2.0
/// \file attempt.h  Data kept of one attempt, to be judged by thresholds and courses.
/// Files: schemas/attempts.schema.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/assessment/milestone.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/base/result.h"

namespace trocar::assessment {

struct Attempt {
  std::string course, step;  ///< for which it was made; both empty: it counts wherever it fits
  std::string task;          ///< key of the task or operation
  std::string level;         ///< of a task
  std::string patient;       ///< of an operation: "seed 7", folder, or empty for the scene's own
  std::uint64_t seed = 0;
  Milestone from = Milestone::kStart, until = Milestone::kCompleted;  ///< of an operation
  std::string started;          ///< wall clock with offset: "2026-11-24T22:50:20+00:00"
  std::string recording;        ///< file, or empty
  std::optional<double> score;  ///< of a task, as shown
  AttemptResult result;         ///< completed: the task, or the part of the operation
};

/// \return the file's error with its JSON path
base::Result<std::vector<Attempt>> ReadAttempts(const std::filesystem::path& path);
/// As ReadAttempts reads them.
std::string FormatAttempts(const std::vector<Attempt>& attempts);
/// Adds one at the end of the file, or of a new one. Two programs that add at once would lose one: the file is locked meanwhile.
/// \return the file's error, kFileInUse, kFileUnwritable
base::Status AppendAttempt(const std::filesystem::path& path, const Attempt& attempt);

}  // namespace trocar::assessment
