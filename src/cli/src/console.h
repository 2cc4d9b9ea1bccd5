// SPDX-License-Identifier: Apache-2.0
/// \file console.h  What the commands print with: tables and progress.
#pragma once

#include <string_view>

#include "trocar/core/progress_bar.h"
#include "trocar/core/text_table.h"

namespace trocar::cli {

using core::FormatNumber;
using core::FormatTable;
using core::ProgressBar;

/// What libraries tell of their progress [0, 1], shown by a bar that outlives it.
inline auto ShownBy(ProgressBar& bar) {
  return [&bar](std::string_view what, double part) {
    bar.SetLabel(what);
    bar.Show(part);
  };
}

}  // namespace trocar::cli
