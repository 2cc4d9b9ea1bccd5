// SPDX-License-Identifier: Apache-2.0
/// \file to_integer.h  Integers from floating-point numbers, the same on every processor.
///
/// C++ leaves a conversion undefined where the result does not fit: x86 then gives the lowest number of the type or what is
/// left of a longer one, ARM the nearest, and WebAssembly the nearest or a trap. Here what lies beyond the range gives the
/// range's end, an infinity as well, and what is not a number gives 0. tests/banned_code finds conversions elsewhere.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>

namespace trocar::base {

/// Towards zero: 2.9 gives 2, -2.9 gives -2.
///
/// \param x  any; a float is exact as a double
/// \return  in the range of Integer; 0 where x is not a number
/// \note Real-time safe: no allocation, lock or throw.
template <std::integral Integer>
#if defined(__GNUC__)  // clang too; the conversion below is in range
__attribute__((no_sanitize("float-cast-overflow")))
#endif
constexpr Integer
TruncateTo(double x) noexcept {
  using Limits = std::numeric_limits<Integer>;
  // the highest of 64 bits is no double: it becomes the power of two above it, and the next double below fits
  constexpr auto kLowest = static_cast<double>(Limits::min()), kHighest = static_cast<double>(Limits::max());
  if (x >= kHighest) return Limits::max();
  if (x >= kLowest) return static_cast<Integer>(x);
  return x < kLowest ? Limits::min() : Integer{0};
}

/// Down: 2.9 gives 2, -2.1 gives -3. Otherwise as TruncateTo.
template <std::integral Integer>
Integer FloorTo(double x) noexcept {
  return TruncateTo<Integer>(std::floor(x));
}

/// Up: 2.1 gives 3, -2.9 gives -2. Otherwise as TruncateTo.
template <std::integral Integer>
Integer CeilTo(double x) noexcept {
  return TruncateTo<Integer>(std::ceil(x));
}

/// To the nearest, halves away from zero as std::lround: 2.5 gives 3, -2.5 gives -3. Otherwise as TruncateTo.
template <std::integral Integer>
Integer RoundTo(double x) noexcept {
  return TruncateTo<Integer>(std::round(x));
}

}  // namespace trocar::base
