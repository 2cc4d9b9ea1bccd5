// SPDX-License-Identifier: Apache-2.0
/// \file log.h  Lines for the person who runs the program, on standard error.
#pragma once

#include <string_view>

namespace trocar::host {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Lines below this level are dropped; kInfo unless set.
void SetLogLevel(LogLevel level);

/// Writes one line. Never from a tick or a haptic loop.
/// \note Not real-time safe: allocates, locks and writes.
void Log(LogLevel level, std::string_view text);

}  // namespace trocar::host
