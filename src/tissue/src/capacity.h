// SPDX-License-Identifier: Apache-2.0
/// \file capacity.h  Reserves spare capacity, so that a change of topology allocates nothing.
#pragma once

#include <cstddef>

namespace trocar::tissue {

/// Spare elements beyond the share: small levels grow by more than their share.
inline constexpr std::size_t kLeastCapacity = 1024;

/// Capacity for `share` times more elements than `count`, and kLeastCapacity more; without a share for `count`.
inline std::size_t AddSpare(std::size_t count, double share) {
  if (!(share > 0.0)) return count;
  return count + static_cast<std::size_t>(share * static_cast<double>(count)) + kLeastCapacity;
}

/// Capacity in each of the vectors for `count` elements and the share.
template <typename... Vectors>
void ReserveWithSpare(std::size_t count, double share, Vectors&... vectors) {
  (vectors.reserve(AddSpare(count, share)), ...);
}

}  // namespace trocar::tissue
