// SPDX-License-Identifier: Apache-2.0
// A saved state in fewer bytes (zstd, byte planes apart): alone, or with what it has in common with another one left out.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace trocar::record {

/// A state as others are told apart from it; made once for many.
class StatePlanes {
 public:
  explicit StatePlanes(std::span<const std::byte> state);
  std::span<const std::byte> Bytes() const { return planes_; }

 private:
  std::vector<std::byte> planes_;
};

/// \param base  null, or the one that it is told apart from
std::vector<std::byte> CompressState(std::span<const std::byte> state, const StatePlanes* base);
/// \return nothing where the bytes are none of CompressState's with that base
std::vector<std::byte> ExpandState(std::span<const std::byte> bytes, const StatePlanes* base);
/// Whether CompressState had a base; false where the bytes are none of its.
bool HasBase(std::span<const std::byte> bytes);

}  // namespace trocar::record
