// SPDX-License-Identifier: Apache-2.0
/// \file thread_allocations.h  How often the calling thread asked for memory.
#pragma once

#include <cstdint>

namespace trocar::bench {

/// Calls of operator new on this thread so far. Whoever links this counts: it stands in place of the standard one.
std::uint64_t CountThreadAllocations() noexcept;
/// False under a sanitizer, which has an operator new of its own; then nothing is counted.
bool CanCountAllocations() noexcept;

}  // namespace trocar::bench
