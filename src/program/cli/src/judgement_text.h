// SPDX-License-Identifier: Apache-2.0
/// \file judgement_text.h  Thresholds and verdicts as people and programs read them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trocar/assessment/proficiency.h"

namespace trocar::cli {

/// "Path length, left hand: at most 1240 mm (economy)"
std::string DescribeThreshold(const assessment::Threshold& threshold);

/// One line a threshold, then composite and grade.
void PrintVerdict(const assessment::Verdict& verdict);
nlohmann::ordered_json VerdictJson(const assessment::Verdict& verdict);

}  // namespace trocar::cli
