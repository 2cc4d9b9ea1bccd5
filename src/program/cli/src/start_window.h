// SPDX-License-Identifier: Apache-2.0
/// \file start_window.h  Starts the program with the windows.
#pragma once

#include <string>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::cli {

/// Becomes the program trocar-window beside this one; comes back only when that fails.
/// \return kWindowMissing with what to do
base::Error StartWindow(const std::vector<std::string>& arguments);

}  // namespace trocar::cli
