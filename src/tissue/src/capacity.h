// SPDX-License-Identifier: Apache-2.0
/// \file capacity.h  Reserves spare capacity, so that a change of topology allocates nothing.
#pragma once

#include <cstddef>

namespace trocar::tissue {

/// Spare elements beyond the share: small levels grow by more than their share.
inline constexpr std::size_t kLeastCapacity = 1024;

/// Spare capacity of `share` times the elements there are, and kLeastCapacity more.
template <typename... Vectors>
void ReserveMore(double share, Vectors&... vectors) {
  const auto reserve = [share](auto& v) {
    v.reserve(v.size() + static_cast<std::size_t>(share * static_cast<double>(v.size())) + kLeastCapacity);
  };
  (reserve(vectors), ...);
}

}  // namespace trocar::tissue
