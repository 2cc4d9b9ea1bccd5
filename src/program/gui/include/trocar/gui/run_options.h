// SPDX-License-Identifier: Apache-2.0
/// \file run_options.h  Whether a person is there, or the window saves its picture and closes by itself.
#pragma once

#include <filesystem>

namespace trocar::gui {

struct RunOptions {
  std::filesystem::path
      screenshot;               ///< empty: a person is there. Otherwise save the window's picture and quit
  double screenshot_after = 5;  ///< [s]

  bool IsAttended() const { return screenshot.empty(); }
};

}  // namespace trocar::gui
