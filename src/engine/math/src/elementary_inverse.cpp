// SPDX-License-Identifier: Apache-2.0
// The angles that belong to a sine, a cosine, or two sides.
// Sources: Muller, "Elementary Functions", 3rd edition, chapters 4 and 6; Gal and Bachelis, "An accurate elementary
// mathematical library for the IEEE floating point standard", ACM TOMS 17, 1991 (table of the arc tangent).
#include <utility>

#include "double_double.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::math {
namespace {

/// asin(s) - s for s = sqrt(z) <= 1/2, each given in two doubles: a sixth of the cube, multiplied out, and the rest.
Pair CalcArcSineRest(const Pair& s, const Pair& z) noexcept {
  const double s_high = KeepHigh(s.high), z_high = KeepHigh(z.high);
  const double low =
      (s.high - s_high) * z.high + s_high * (z.high - z_high) + (s.low * z.high + s.high * z.low);
  const double* a = kArcSineTerms;
  const double t = z.high, t2 = t * t, t4 = t2 * t2;
  const double first = (a[1] + t * a[2]) + t2 * (a[3] + t * a[4]);
  const double second = (a[5] + t * a[6]) + t2 * (a[7] + t * a[8]);
  const double third = (a[9] + t * a[10]) + t2 * (a[11] + t * a[12]);
  return {s_high * z_high * a[0], low * a[0] + s.high * (t2 * (first + t4 * (second + t4 * third)))};
}

/// asin(x) for |x| <= 1/2.
Pair CalcSmallAngle(double x) noexcept {
  const double square = x * x, high = KeepHigh(x);
  const Pair rest = CalcArcSineRest({x, 0.0}, {square, (high * high - square) + (x - high) * (x + high)});
  const Pair sum = FastTwoSum(x, rest.high);
  return {sum.high, sum.low + rest.low};
}

/// asin(sqrt(z)), which is half of a large angle.
/// \pre 0 < z <= 1/4
Pair CalcHalfAngle(double z) noexcept {
  const double root = std::sqrt(z), high = KeepHigh(root);
  const double low = (z - high * high) / (root + high) - (root - high);
  const Pair rest = CalcArcSineRest({root, low}, {z, 0.0});
  const Pair sum = FastTwoSum(root, rest.high);
  return {sum.high, sum.low + (low + rest.low)};
}

/// The angle of (x, y) with the x axis where y / x says nothing or is very small or large.
double AngleOfSpecial(double y, double x) noexcept {
  if (x != x || y != y) return kNaN;
  const double y_size = std::fabs(y), x_size = std::fabs(x);
  double angle = 0.0;
  if (y_size == kInfinity && x_size == kInfinity) {
    angle = x > 0 ? 0.5 * kHalfPi.high : 1.5 * kHalfPi.high;
  } else if (y == 0.0 || x_size == kInfinity) {
    angle = std::signbit(x) ? kPi.high : 0.0;
  } else if (y_size > x_size) {
    angle = kHalfPi.high;
  } else {
    angle = x > 0 ? y_size / x_size : kPi.high;
  }
  return std::copysign(angle, y);
}

}  // namespace

double Asin(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < 1.0)) return size == 1.0 ? std::copysign(kHalfPi.high, x) : kNaN;
  if (size < 0x1p-27) return x;
  if (size < 0.5) {
    const Pair angle = CalcSmallAngle(x);
    return angle.high + angle.low;
  }
  // pi/2 less the angle that has the cosine |x|
  const Pair half = CalcHalfAngle(0.5 * (1.0 - size));
  const Pair sum = FastTwoSum(kHalfPi.high, -2.0 * half.high);
  return std::copysign(sum.high + (sum.low + (kHalfPi.low - 2.0 * half.low)), x);
}

double Acos(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < 1.0)) {
    if (size == 1.0) return x > 0 ? 0.0 : kPi.high;
    return kNaN;
  }
  if (size < 0.5) {
    const Pair angle = CalcSmallAngle(x), sum = FastTwoSum(kHalfPi.high, -angle.high);
    return sum.high + (sum.low + (kHalfPi.low - angle.low));
  }
  const Pair half = CalcHalfAngle(0.5 * (1.0 - size));
  if (x > 0) return 2.0 * (half.high + half.low);
  const Pair sum = FastTwoSum(kPi.high, -2.0 * half.high);
  return sum.high + (sum.low + (kPi.low - 2.0 * half.low));
}

double Atan2(double y, double x) noexcept {
  double large = std::fabs(x), small = std::fabs(y);
  const bool is_steep = small > large;
  if (is_steep) std::swap(large, small);
  // also where one is NaN
  if (!(large < kInfinity && small > large * 0x1p-60)) return AngleOfSpecial(y, x);
  if (large > 0x1p500) {
    large *= 0x1p-600;
    small *= 0x1p-600;
  } else if (large < 0x1p-400) {
    large *= 0x1p600;
    small *= 0x1p600;
  }

  // small / large = tan(a) with a = atan(c) + atan(r), c = i / 64, r = (small - c large) / (large + c small)
  const int i = base::TruncateTo<int>(small / large * 64.0 + 0.5);
  const double c = i * 0x1p-6;
  const double large_high = KeepHigh(large), small_high = KeepHigh(small);
  const Pair above = FastTwoSum(small - c * large_high, -c * (large - large_high));
  const double c_small = c * small, c_small_low = (c * small_high - c_small) + c * (small - small_high);
  const Pair below_sum = FastTwoSum(large, c_small);
  const Pair below{below_sum.high, below_sum.low + c_small_low};
  const double inverse = 1.0 / below.high, r = above.high * inverse;
  const Pair product = TwoProduct(r, below.high);
  const double missing = ((above.high - product.high) - product.low) + (above.low - r * below.low);
  const double r2 = r * r;
  const Pair& row = kArcTangentTable[i];
  const double rest = row.low + missing * inverse + r * (r2 * Quadratic(kArcTangentTerms, r2));

  // from the nearer axis, there or back
  constexpr Pair kZero{0.0, 0.0};
  const bool is_left = std::signbit(x);
  const Pair& axis = is_steep ? kHalfPi : (is_left ? kPi : kZero);
  const double sign = is_steep == is_left ? 1.0 : -1.0;
  const Pair first = FastTwoSum(axis.high, sign * row.high);
  const Pair second = FastTwoSum(first.high, sign * r);
  return std::copysign(second.high + (second.low + first.low + (axis.low + sign * rest)), y);
}

}  // namespace trocar::math
