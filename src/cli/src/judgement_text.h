// SPDX-License-Identifier: Apache-2.0
/// \file judgement_text.h  Thresholds and verdicts as people and programs read them.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trocar/assessment/proficiency.h"

namespace trocar::cli {

/// Lines of at most `width` columns, each with the indent and ending with a newline.
std::string WrapText(const std::string& text, std::size_t width, const std::string& indent);

/// "path_length, left hand: at most 1240 mm (economy)"
std::string DescribeThreshold(const assessment::Threshold& threshold);

/// One line a threshold, then composite and grade.
void PrintVerdict(const assessment::Verdict& verdict);
nlohmann::ordered_json VerdictJson(const assessment::Verdict& verdict);

}  // namespace trocar::cli
