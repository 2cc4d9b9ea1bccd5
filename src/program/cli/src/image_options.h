// SPDX-License-Identifier: Apache-2.0
/// \file image_options.h  Options about images on the command line, parsed from text.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::cli {

/// "left,posterior,superior".
/// \return kUsage unless there are three words
base::Result<std::array<std::string, 3>> ParseAxes(const std::string& text);

/// "40,400": centre and width.
/// \return kUsage unless these are two numbers, the second above 0
base::Result<images::DisplayWindow> ParseWindow(const std::string& text);

}  // namespace trocar::cli
