// SPDX-License-Identifier: Apache-2.0
// Cube root and hypotenuse: an approximation, then its exact remainder.
// Sources: Halley's iteration, as in Muller, "Elementary Functions", 3rd edition, chapter 5; Borges, "An improved
// algorithm for hypot(a,b)", arXiv:1904.09481, 2019.
#include <utility>

#include "double_double.h"
#include "trocar/math/elementary.h"

namespace trocar::math {
namespace {

/// sqrt(a^2 + b^2), and what is missing from it.
/// \pre a >= b > 0; the squares neither overflow nor vanish beside each other
Pair HypotOf(double a, double b) noexcept {
  const Pair a2 = TwoProduct(a, a), b2 = TwoProduct(b, b);
  const Pair sum = FastTwoSum(a2.high, b2.high);
  const double root = std::sqrt(sum.high);
  const Pair square = TwoProduct(root, root);
  const double missing = ((sum.high - square.high) - square.low) + (sum.low + a2.low + b2.low);
  return {root, missing / (2.0 * root)};
}

}  // namespace

double Cbrt(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < kInfinity)) return x != x ? kNaN : x;
  if (size == 0.0) return x;
  // |x| = 2^(3 third + left) m with m in [1, 2)
  const bool is_subnormal = size < 0x1p-1022;
  const std::uint64_t bits = BitsOf(is_subnormal ? size * 0x1p54 : size);
  // 3 * 376 is added so that the quotient is not negative
  const int exponent = static_cast<int>(bits >> 52) - 1023 + 3 * 376 - (is_subnormal ? 54 : 0);
  const int third = exponent / 3, left = exponent % 3;
  const double m = FromBits((bits & 0xfffffffffffffULL) | 0x3ff0000000000000ULL);
  const double cube = m * PowerOfTwo(left);

  double root = kCubeRoots[left] * ((kCubeRootTerms[0] + m * kCubeRootTerms[1]) +
                                    m * m * (kCubeRootTerms[2] + m * kCubeRootTerms[3]));
  const double approximate_cube = root * root * root;
  root = KeepHigh(root * (approximate_cube + 2.0 * cube) / (2.0 * approximate_cube + cube));
  // root^2 is exact, and so are both products of its parts with root
  const double square = root * root, square_high = KeepHigh(square);
  const double missing = (cube - square_high * root) - (square - square_high) * root;
  root += root * missing / (2.0 * square * root + cube);
  return std::copysign(root * PowerOfTwo(third - 376), x);
}

double Hypot(double x, double y) noexcept {
  double a = std::fabs(x), b = std::fabs(y);
  if (a == kInfinity || b == kInfinity) return kInfinity;
  if (x != x || y != y) return kNaN;
  if (a < b) std::swap(a, b);
  if (b <= a * 0x1p-54) return a + b;
  if (a > 0x1p510) {
    const Pair sum = HypotOf(a * 0x1p-600, b * 0x1p-600);
    return (sum.high + sum.low) * 0x1p600;
  }
  if (a < 0x1p-450) {
    const Pair sum = HypotOf(a * 0x1p600, b * 0x1p600);
    return ScaleToTiny(sum.high * 0x1p422, sum.low * 0x1p422);
  }
  const Pair sum = HypotOf(a, b);
  return sum.high + sum.low;
}

}  // namespace trocar::math
