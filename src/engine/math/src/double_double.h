// SPDX-License-Identifier: Apache-2.0
/// \file double_double.h  Sums and products of doubles together with their rounding errors; bits of doubles.
/// Sources: Dekker, "A floating-point technique for extending the available precision", Numerische Mathematik 18,
/// 1971; Knuth, "The Art of Computer Programming", vol. 2, section 4.2.2.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "elementary_constants.h"

namespace trocar::math {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline std::uint64_t BitsOf(double x) noexcept {
  return std::bit_cast<std::uint64_t>(x);
}
inline double FromBits(std::uint64_t bits) noexcept {
  return std::bit_cast<double>(bits);
}
/// \pre -1022 <= exponent <= 1023
inline double PowerOfTwo(int exponent) noexcept {
  return FromBits(static_cast<std::uint64_t>(1023 + exponent) << 52);
}

/// The first 26 significant bits, cut off: products of two such numbers are exact.
inline double KeepHigh(double x) noexcept {
  return FromBits(BitsOf(x) & ~((std::uint64_t{1} << 27) - 1));
}

/// a + b and its rounding error.
/// \pre |a| >= |b|, or a is 0
inline Pair FastTwoSum(double a, double b) noexcept {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a + b and its rounding error, whichever is larger.
inline Pair TwoSum(double a, double b) noexcept {
  const double sum = a + b, part_b = sum - a;
  return {sum, (a - (sum - part_b)) + (b - part_b)};
}

/// a b and its rounding error; of the latter a part of 2^-53 is lost.
inline Pair TwoProduct(double a, double b) noexcept {
  const double product = a * b;
  const double a_high = KeepHigh(a), a_low = a - a_high;
  const double b_high = KeepHigh(b), b_low = b - b_high;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// (high + low) 2^-1022, rounded once also where that is subnormal.
/// \pre high >= 0, |low| well below high
inline double ScaleToTiny(double high, double low) noexcept {
  const Pair value = FastTwoSum(high, low);
  if (value.high >= 1.0) return value.high * 0x1p-1022;
  // beside 1 the last bit is the last one of the result
  const Pair sum = FastTwoSum(1.0, value.high);
  return ((sum.high + (sum.low + value.low)) - 1.0) * 0x1p-1022;
}

/// a0 + a1 x + a2 x^2
inline double Quadratic(const double (&a)[3], double x) noexcept {
  return a[0] + x * (a[1] + x * a[2]);
}

}  // namespace trocar::math
