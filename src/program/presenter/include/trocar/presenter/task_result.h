// SPDX-License-Identifier: Apache-2.0
/// \file task_result.h  Result of a task, for a person and for files. No widget.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::presenter {

/// Keeps every error of a run; a snapshot lists the newest alone.
class TaskErrorLog {
 public:
  /// Takes over what is new. A run that began anew empties the log.
  void Add(const scene::TaskSnapshot& now);
  const std::vector<scene::TaskError>& Errors() const { return errors_; }

 private:
  std::vector<scene::TaskError> errors_;
  std::uint64_t seen_ = 0;
};

struct TaskResult {
  struct GoalRow {
    std::string name;
    bool is_done = false;
  };
  struct ErrorRow {
    double time = 0;  ///< since the first movement [s]
    std::string name, about, severity;
    std::string by;  ///< "left grasper", "ring"; empty where nothing is named
    double penalty = 0;
    math::Vec3 position;  ///< world frame [m]
  };
  std::string task, level;
  std::uint64_t seed = 0;
  bool is_demonstration = false;  ///< of the scripted expert, nobody's own
  scene::TaskPhase phase = scene::TaskPhase::kNone;
  std::string verdict;  ///< "Completed", "The time is over", "Ended by an error"
  double time = 0;      ///< [s]
  double score = 0;
  bool is_score_percent = false;  ///< of an able surgeon's points: then 0 to `best_score`
  double best_score = 100;        ///< of this level
  std::string recording;          ///< file of the attempt; empty where it is not kept
  std::vector<GoalRow> goals;
  std::vector<ErrorRow> errors;
};

/// \pre the scene has a task (TROCAR_ASSERT)
TaskResult MakeTaskResult(const scene::Scene& scene, const scene::TaskSnapshot& now,
                          const std::vector<scene::TaskError>& errors);

/// "74.3 of 85", "87.4 points"
std::string FormatScore(const TaskResult& result);
/// Cause of an error, in words of the chosen language: "ring 1, left hand".
std::string DescribeDoer(const TaskResult::ErrorRow& error);

/// Everything, as an object with "format": "trocar-task-result".
std::string FormatTaskResultJson(const TaskResult& result);
/// A page of its own.
std::string FormatTaskResultHtml(const TaskResult& result);

}  // namespace trocar::presenter
