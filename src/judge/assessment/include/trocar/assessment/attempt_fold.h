// SPDX-License-Identifier: Apache-2.0
/// \file attempt_fold.h  An attempt measured tick by tick, the same code while it is played and when its recording is replayed.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "trocar/assessment/milestone.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/base/result.h"
#include "trocar/record/trace.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_trace.h"

namespace trocar::assessment {

/// Trace and result of an attempt that was played or replayed.
struct PlayedAttempt {
  training::AttemptTrace trace;  ///< its outcome has a task's score, as shown
  AttemptResult result;          ///< completed: the task, or the part of the operation
  std::string task_name;         ///< of the scene: "Peg transfer"; a scene's own name where it has no task
  std::optional<double> best_score;  ///< scene::Task::best_score [%], where the score is of it
};

/// Takes an attempt in, tick by tick. The same snapshots and controls give the same bits, whoever plays.
class AttemptFold {
 public:
  /// \param simulation   where the attempt begins; its snapshot is the first that is taken in
  /// \param from, until  the part of an operation; kCompleted: to the end
  AttemptFold(const simulation::Simulation& simulation, Milestone from, Milestone until);

  /// One tick more; nothing once the part is over.
  /// \note Not real-time safe: allocates as record::TraceBuilder::Add, once in kReservedSeconds.
  void Add(const simulation::Snapshot& now,
           const std::array<scene::HandControls, instrument::kHandCount>& controls);
  /// Whether the last moment of the part has come: what follows does not count.
  bool IsOver() const { return is_part_ && watch_.HasReached(until_); }

  /// The attempt so far, as if it ended here. \return the metrics' error
  base::Result<PlayedAttempt> Calc() const;

 private:
  record::TraceBuilder builder_;
  MilestoneWatch watch_;
  Milestone until_;
  bool is_part_;
  std::string task_name_;
  std::optional<double> best_score_;
};

}  // namespace trocar::assessment
