// SPDX-License-Identifier: Apache-2.0
/// \file capacity.h  Vectors that have room for a larger model, so that a change of topology allocates nothing.
#pragma once

#include <cstddef>

namespace trocar::tissue {

/// Elements that a vector has room for beyond its share: small levels grow by more than their share.
inline constexpr std::size_t kLeastCapacity = 1024;

/// Room for `share` times more elements than there are, and a few.
template <typename... Vectors>
void ReserveMore(double share, Vectors&... vectors) {
  const auto reserve = [share](auto& v) {
    v.reserve(v.size() + static_cast<std::size_t>(share * static_cast<double>(v.size())) + kLeastCapacity);
  };
  (reserve(vectors), ...);
}

}  // namespace trocar::tissue
