// SPDX-License-Identifier: Apache-2.0
/// \file console.h  What the commands print with: tables and progress.
#pragma once

#include "trocar/core/progress_bar.h"
#include "trocar/core/text_table.h"

namespace trocar::cli {

using core::FormatNumber;
using core::FormatTable;
using core::ProgressBar;

}  // namespace trocar::cli
