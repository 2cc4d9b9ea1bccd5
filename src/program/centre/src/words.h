// SPDX-License-Identifier: Apache-2.0
/// \file words.h  Numbers and keys as a person reads them.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "trocar/assessment/proficiency.h"

namespace trocar::centre {

/// "Path length, left hand"
std::string MetricName(const assessment::MetricKey& key);
/// "1 240 mm" in the unit that is shown.
std::string MetricText(const std::string& metric, double value);
/// "at most 60 s"
std::string LimitText(const assessment::Threshold& threshold);
/// "Path length, left hand: at most 900 mm"
std::string ThresholdText(const assessment::Threshold& threshold);
/// "87.4 %" or "87.4 points"
std::string ScoreText(double score, bool is_percent);

/// Looks up in the delivered files what tasks are called and how they are scored, each file once.
class TaskBook {
 public:
  /// As TaskNameOf.
  const std::string& NameOf(const std::string& task);
  /// Whether a task's score is in per cent of an able surgeon's.
  bool IsScorePercent(const std::string& task, const std::string& level);

 private:
  std::map<std::string, std::string> names_;
  std::map<std::pair<std::string, std::string>, bool> is_percent_;  // of task and level
};

}  // namespace trocar::centre
