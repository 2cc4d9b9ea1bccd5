// SPDX-License-Identifier: Apache-2.0
/// \file aligned_vector.h  Vectors that begin at a cache line, so that no load of 64 bytes touches two.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace trocar::math {

/// Bytes of a cache line and of the widest vector register.
inline constexpr std::size_t kCacheLine = 64;

/// Memory that begins at a cache line.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}

  // the standard names these
  T* allocate(std::size_t count) {  // NOLINT(readability-identifier-naming)
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{kCacheLine}));
  }
  void deallocate(T* memory, std::size_t) noexcept {  // NOLINT(readability-identifier-naming)
    ::operator delete (memory, std::align_val_t{kCacheLine});
  }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) noexcept { return true; }
};

/// Vector that begins at a cache line, for kernels that read or write a whole vector register at a time.
template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace trocar::math
