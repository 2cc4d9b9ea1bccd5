// SPDX-License-Identifier: Apache-2.0
/// \file state_hash.h  A 64-bit fingerprint of simulation state, for determinism checks. Not for security.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>

namespace trocar::base {

/// 16 lower-case hexadecimal digits.
inline std::string HashText(std::uint64_t hash) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, hash >>= 4) *digit = kDigits[hash & 15];
  return text;
}

/// FNV-1a over 64-bit words with a final avalanche (Fowler, Noll, Vo; finaliser of MurmurHash3).
class StateHash {
 public:
  void Add(std::uint64_t word) noexcept { hash_ = (hash_ ^ word) * 0x100000001b3ULL ^ (hash_ >> 47); }
  void Add(double value) noexcept { Add(std::bit_cast<std::uint64_t>(value)); }
  void Add(std::span<const double> values) noexcept {
    for (const double value : values) Add(value);
  }

  std::uint64_t Value() const noexcept {
    std::uint64_t h = hash_;
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdULL;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    return h ^ (h >> 33);
  }

  std::string Text() const { return HashText(Value()); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace trocar::base
