// SPDX-License-Identifier: Apache-2.0
/// \file spare_capacity.h  Reserves spare capacity, so that lists which grow a little later, as after a cut, allocate nothing then.
#pragma once

#include <cstddef>

#include "trocar/base/to_integer.h"

namespace trocar::base {

/// Spare elements beyond the share: short lists grow by more than their share.
inline constexpr std::size_t kLeastCapacity = 1024;

/// Capacity for `share` times more elements than `count`, and kLeastCapacity more; without a share for `count`.
inline std::size_t AddSpare(std::size_t count, double share) {
  if (!(share > 0.0)) return count;
  return count + TruncateTo<std::size_t>(share * static_cast<double>(count)) + kLeastCapacity;
}

/// Capacity in each of the vectors for `count` elements and the share.
template <typename... Vectors>
void ReserveWithSpare(std::size_t count, double share, Vectors&... vectors) {
  (vectors.reserve(AddSpare(count, share)), ...);
}

}  // namespace trocar::base
