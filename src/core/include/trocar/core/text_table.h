// SPDX-License-Identifier: Apache-2.0
/// \file text_table.h  Numbers and tables as text for a person.
#pragma once

#include <string>
#include <vector>

namespace trocar::core {

/// Number with `digits` significant digits, as short as it can be: "12.3", "0.00451", "not a number".
std::string FormatNumber(double value, int digits = 4);

/// Lines of columns, each as wide as its widest cell; cells that are numbers stand at the right.
///
/// \param rows  the first is the heading; shorter rows end early
/// \return every line ends with a newline
std::string FormatTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace trocar::core
