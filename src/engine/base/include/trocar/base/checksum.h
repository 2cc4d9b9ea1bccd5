// SPDX-License-Identifier: Apache-2.0
/// \file checksum.h  Checksum of bytes that are saved or sent. It finds damage; it is no signature.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "trocar/base/state_hash.h"

namespace trocar::base {

/// Takes eight bytes at a time. Zeros behind the last eight do not count: the length has to be known.
inline std::uint64_t CalcChecksum(std::span<const std::byte> bytes) noexcept {
  StateHash hash;
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data() + at, 8);
    hash.Add(word);
  }
  std::uint64_t rest = 0;
  std::memcpy(&rest, bytes.data() + at, bytes.size() - at);
  hash.Add(rest);
  return hash.Value();
}

}  // namespace trocar::base
