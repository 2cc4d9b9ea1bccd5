// SPDX-License-Identifier: Apache-2.0
/// \file text_table.h  Numbers and tables as text for a person.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace trocar::host {

/// Number with `digits` significant digits, as short as it can be: "12.3", "0.00451", "not a number".
std::string FormatNumber(double value, int digits = 4);

/// Is the text a number and nothing else, with a point or a comma as decimal mark?
bool IsNumberText(std::string text);

/// Lines of columns, each as wide as its widest cell; cells that are numbers stand at the right.
///
/// \param rows  the first is the heading; shorter rows end early
/// \return every line ends with a newline
std::string FormatTable(const std::vector<std::vector<std::string>>& rows);

/// Lines of at most `width` columns, each with the indent and ending with a newline. A line end in the text becomes visible.
std::string WrapText(const std::string& text, std::size_t width, const std::string& indent);

}  // namespace trocar::host
