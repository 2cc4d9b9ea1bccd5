// SPDX-License-Identifier: Apache-2.0
/// \file image_options.h  Options about images on the command line, parsed from text.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
class Option;
}  // namespace CLI

namespace trocar::cli {

/// --series N. What options fill lives as long as the command.
CLI::Option* AddSeriesOption(CLI::App& command, int& series);
/// --pattern NAME
CLI::Option* AddPatternOption(CLI::App& command, std::string& pattern);
/// --pixel-mm and --slice-mm [mm]
void AddSpacingOptions(CLI::App& command, std::optional<double>& pixel_mm, std::optional<double>& slice_mm);

/// "left,posterior,superior".
/// \return kUsage unless there are three words
base::Result<std::array<std::string, 3>> ParseAxes(const std::string& text);

/// "40,400": centre and width.
/// \return kUsage unless these are two numbers, the second above 0
base::Result<images::DisplayWindow> ParseWindow(const std::string& text);

}  // namespace trocar::cli
