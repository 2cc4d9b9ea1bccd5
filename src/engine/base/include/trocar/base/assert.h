// SPDX-License-Identifier: Apache-2.0
/// \file assert.h  Preconditions. A failed one is a bug of ours, never bad input.
#pragma once

namespace trocar::base {

/// Called with what failed and where; must not return. Tests replace it to look at the message.
using AssertHandler = void (*)(const char* condition, const char* file, int line);

/// Replaces the handler and returns the former one; nullptr restores the default, which logs and aborts.
AssertHandler SetAssertHandler(AssertHandler handler) noexcept;

/// Runs the handler, then aborts if it returned.
[[noreturn]] void FailAssert(const char* condition, const char* file, int line);

}  // namespace trocar::base

#if defined(TROCAR_ENABLE_ASSERTS)
#define TROCAR_ASSERT(condition) \
  (static_cast<bool>(condition) ? void(0) : ::trocar::base::FailAssert(#condition, __FILE__, __LINE__))
#else
#define TROCAR_ASSERT(condition) void(sizeof(static_cast<bool>(condition)))
#endif
