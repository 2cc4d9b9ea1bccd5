// SPDX-License-Identifier: Apache-2.0
/// \file words.h  Numbers and keys as a person reads them.
#pragma once

#include <string>

#include "trocar/assessment/proficiency.h"

namespace trocar::centre {

/// "1 attempt", "3 attempts"
std::string Count(std::size_t count, const std::string& one);
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
/// Whether a task's score is in per cent of an able surgeon's.
bool IsScorePercent(const std::string& task, const std::string& level);

}  // namespace trocar::centre
