// SPDX-License-Identifier: Apache-2.0
/// \file task_parameters.h  Numbers of a task file that level and seed decide.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/files/task_file.h"
#include "trocar/host/json.h"

namespace trocar::files {

using ParameterValues = std::map<std::string, double, std::less<>>;

/// Values of the parameters at a level. The seed moves each by its `spread`; where the task varies also by its `vary`, and
/// shuffles what the file shuffles. What a varied task draws is no part of the row that a standardised one draws, so that one
/// seed means the same to whoever does not vary.
/// \param root  complains
ParameterValues CalcParameters(const host::JsonView& root, const std::vector<std::string>& levels,
                               const TaskChoice& choice);

/// The text with numbers in the place of each string that is a sum over parameters: "{x}", "-{x}", "{x} - 59",
/// "0.38*{bend} + 27.9". A string with a name that is none of them stays.
std::string SubstituteParameters(std::string_view text, const ParameterValues& values);

}  // namespace trocar::files
