// SPDX-License-Identifier: Apache-2.0
/// \file task_parameters.h  Numbers of a task file that level and seed decide.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/host/json.h"

namespace trocar::files {

using ParameterValues = std::map<std::string, double, std::less<>>;

/// Parameters of a task at one level.
struct TaskParameters {
  struct Parameter {
    std::string name;
    double value = 0, spread = 0, vary = 0;
    bool is_standard = true;  ///< the seed draws for it at the standardised task, too
  };
  std::vector<Parameter> all;  ///< in alphabetical order
  /// Lists of rows of names, whose values change places.
  std::vector<std::vector<std::vector<std::string>>> shuffled;

  /// The seed moves each by its `spread`; where the task varies also by its `vary`, and shuffles what the file shuffles. What
  /// a varied task draws is no part of the row that a standardised one draws, so that one seed means the same to whoever does
  /// not vary.
  ParameterValues Draw(std::uint64_t seed, bool is_varied) const;
};
/// \param root  complains
TaskParameters ReadTaskParameters(const host::JsonView& root, const std::vector<std::string>& levels,
                                  const std::string& level);

/// The text with numbers in the place of each string that is a sum over parameters: "{x}", "-{x}", "{x} - 59",
/// "0.38*{bend} + 27.9". A string with a name that is none of them stays.
std::string SubstituteParameters(std::string_view text, const ParameterValues& values);
/// JSON without blanks between its parts.
std::string WithoutBlanks(std::string_view json);

}  // namespace trocar::files
