// SPDX-License-Identifier: Apache-2.0
#include "thread_allocations.h"

#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace trocar::bench {
std::uint64_t CountThreadAllocations() noexcept {
  return 0;
}
bool CanCountAllocations() noexcept {
  return false;
}
}  // namespace trocar::bench

#else

namespace {
thread_local std::uint64_t t_allocations = 0;
}  // namespace

namespace trocar::bench {
std::uint64_t CountThreadAllocations() noexcept {
  return t_allocations;
}
bool CanCountAllocations() noexcept {
  return true;
}
}  // namespace trocar::bench

void* operator new(std::size_t size) {
  ++t_allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

#endif
