// SPDX-License-Identifier: Apache-2.0
// Sine, cosine and tangent: the argument is a multiple of pi/32 and a remainder; a table has the sines of the former,
// polynomials those of the latter.
// Sources: Cody and Waite, "Software Manual for the Elementary Functions", 1980; Payne and Hanek, "Radian reduction for
// trigonometric functions", ACM SIGNUM Newsletter 18, 1983; Gal and Bachelis, "An accurate elementary mathematical
// library for the IEEE floating point standard", ACM TOMS 17, 1991.
#include "double_double.h"
#include "trocar/math/elementary.h"

namespace trocar::math {
namespace {

constexpr double kShift = 0x1.8p52;  ///< added and taken away, it leaves the nearest integer
/// Up to here n of x = n pi/32 + r stays below 2^20, and its products with the parts of pi/32 are exact [rad].
constexpr double kNear = 102900.0;
/// A remainder below this has lost too many bits in the subtractions [rad].
constexpr double kCancelled = 0x1p-27;

/// x = steps pi/32 + r, |r| <= pi/64; of the steps only the last six bits count.
struct Remainder {
  Pair r;
  unsigned steps;
};

/// By the digits of 1 / (2 pi) that matter for x.
/// \pre x is finite and not below 2^-10 in size
Remainder ReduceByDigits(double x) noexcept {
  const std::uint64_t bits = BitsOf(x);
  const std::uint64_t mantissa = (bits & 0xfffffffffffffULL) | 0x10000000000000ULL;
  const int exponent = static_cast<int>(bits >> 52 & 0x7ff) - 1075;

  // 192 bits of the fraction, from the one on that is worth 1/2 turn or less; the table begins with 64 zeros
  const int first = exponent + 64;
  std::uint32_t window[6];
  for (int i = 0; i < 6; ++i) {
    const int word = first / 32 + i, shift = first % 32;
    window[i] = static_cast<std::uint32_t>(
        ((std::uint64_t{kInverseTurn[word]} << 32 | kInverseTurn[word + 1]) << shift) >> 32);
  }
  // turns, without whole ones
  std::uint32_t turns[6];
  const std::uint64_t low = mantissa & 0xffffffffu, high = mantissa >> 32;
  std::uint64_t carry = 0;
  for (int i = 5; i >= 0; --i) {
    // what a word gives to itself and, by the mantissa's upper half, to the one before it
    const std::uint64_t by_low = low * window[i];
    const std::uint64_t by_high = i < 5 ? high * window[i + 1] : 0;
    const std::uint64_t sum = (by_low & 0xffffffffu) + (by_high & 0xffffffffu) + (carry & 0xffffffffu);
    turns[i] = static_cast<std::uint32_t>(sum);
    carry = (carry >> 32) + (by_low >> 32) + (by_high >> 32) + (sum >> 32);
  }

  // six bits are the step, the rest is its fraction; one above a half belongs to the next step
  unsigned steps = turns[0] >> 26;
  for (int i = 0; i < 6; ++i) turns[i] = turns[i] << 6 | (i < 5 ? turns[i + 1] >> 26 : 0);
  double sign = 1.0;
  if (turns[0] >> 31) {
    ++steps;
    sign = -1.0;
    for (std::uint32_t& word : turns) word = ~word;  // 2^-186 too small
  }
  Pair fraction{0.0, 0.0};
  double worth = sign * 0x1p-32;
  for (const std::uint32_t word : turns) {
    const Pair sum = FastTwoSum(fraction.high, worth * word);
    fraction = {sum.high, fraction.low + sum.low};
    worth *= 0x1p-32;
  }
  fraction = FastTwoSum(fraction.high, fraction.low);
  const Pair product = TwoProduct(fraction.high, kTurnStepHigh);
  const Pair r =
      FastTwoSum(product.high, product.low + (fraction.high * kTurnStepLow + fraction.low * kTurnStepHigh));
  if (!std::signbit(x)) return {r, steps};
  return {{-r.high, -r.low}, 0u - steps};
}

Remainder Reduce(double x) noexcept {
  if (!(std::fabs(x) <= kNear)) return ReduceByDigits(x);
  const double shifted = x * kTurnInverseStep + kShift;
  const double n = shifted - kShift;
  const auto steps = static_cast<unsigned>(BitsOf(shifted));
  // the first difference is exact
  const Pair second = TwoSum(x - n * kTurnStepFirst, -(n * kTurnStepSecond));
  const Pair r = FastTwoSum(second.high, second.low - n * kTurnStepThird);
  if (n != 0.0 && std::fabs(r.high) < kCancelled) return ReduceByDigits(x);
  return {r, steps};
}

/// What sine and cosine have in common: r in a part of 26 bits and the rest, sin(r) - r, cos(r) - 1.
struct Terms {
  double r, r_high, r_low, sine, cosine;
};

Terms CalcTerms(const Pair& r) noexcept {
  const double r2 = r.high * r.high, r_high = KeepHigh(r.high);
  return {
      r.high, r_high, (r.high - r_high) + r.low, r.high * (r2 * Quadratic(kSineTerms, r2)),
      r2 * ((kCosineTerms[0] + r2 * kCosineTerms[1]) + r2 * r2 * (kCosineTerms[2] + r2 * kCosineTerms[3]))};
}

/// sin(steps pi/32 + r); the cosine is that of 16 steps more.
Pair SineOf(unsigned steps, const Terms& t) noexcept {
  const Pair &sine = kSineTable[steps & 63], &cosine = kSineTable[(steps + 16) & 63];
  const Pair sum = FastTwoSum(sine.high, cosine.high * t.r_high);
  return {sum.high, ((sine.low + sum.low) + (cosine.high * t.r_low + cosine.low * t.r)) +
                        ((sine.high + sine.low) * t.cosine + (cosine.high + cosine.low) * t.sine)};
}

}  // namespace

double Sin(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < kInfinity)) return kNaN;
  if (size < 0x1p-27) return x;
  const Remainder remainder = Reduce(x);
  const Pair sine = SineOf(remainder.steps, CalcTerms(remainder.r));
  return sine.high + sine.low;
}

double Cos(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < kInfinity)) return kNaN;
  if (size < 0x1p-27) return 1.0;
  const Remainder remainder = Reduce(x);
  const Pair cosine = SineOf(remainder.steps + 16, CalcTerms(remainder.r));
  return cosine.high + cosine.low;
}

SineCosine SinCos(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < kInfinity)) return {kNaN, kNaN};
  if (size < 0x1p-27) return {x, 1.0};
  const Remainder remainder = Reduce(x);
  const Terms terms = CalcTerms(remainder.r);
  const Pair sine = SineOf(remainder.steps, terms), cosine = SineOf(remainder.steps + 16, terms);
  return {sine.high + sine.low, cosine.high + cosine.low};
}

double Tan(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < kInfinity)) return kNaN;
  if (size < 0x1p-28) return x;
  const Remainder remainder = Reduce(x);
  const Terms terms = CalcTerms(remainder.r);
  const Pair sine_sum = SineOf(remainder.steps, terms), cosine_sum = SineOf(remainder.steps + 16, terms);
  const Pair sine = FastTwoSum(sine_sum.high, sine_sum.low);
  const Pair cosine = FastTwoSum(cosine_sum.high, cosine_sum.low);
  // the quotient, and what is missing from it
  const double inverse = 1.0 / cosine.high, quotient = sine.high * inverse;
  const Pair product = TwoProduct(quotient, cosine.high);
  const double missing = ((sine.high - product.high) - product.low) + (sine.low - quotient * cosine.low);
  return quotient + missing * inverse;
}

}  // namespace trocar::math
