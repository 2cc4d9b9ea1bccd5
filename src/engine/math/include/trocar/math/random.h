// SPDX-License-Identifier: Apache-2.0
/// \file random.h  Random numbers that are the same on every machine and compiler.
/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (SplitMix64).
#pragma once

#include <cstdint>

namespace trocar::math {

/// SplitMix64. The standard library's distributions differ between implementations, so the map to doubles is
/// ours.
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

  std::uint64_t NextWord() noexcept {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double Uniform() noexcept { return static_cast<double>(NextWord() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double Uniform(double low, double high) noexcept { return low + (high - low) * Uniform(); }

 private:
  std::uint64_t state_;
};

}  // namespace trocar::math
