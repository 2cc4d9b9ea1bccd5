// SPDX-License-Identifier: Apache-2.0
// Exponential, logarithms and powers: a table brings the argument near 0 or 1, a polynomial does the rest.
// Source: Tang, "Table-driven implementation of the exponential function in IEEE floating-point arithmetic", ACM TOMS
// 15, 1989, and "Table-driven implementation of the logarithm function", ACM TOMS 16, 1990; Muller, "Elementary
// Functions", 3rd edition, chapter 6.
#include "double_double.h"
#include "trocar/math/elementary.h"

namespace trocar::math {
namespace {

constexpr double kShift = 0x1.8p52;  ///< added and taken away, it leaves the nearest integer

/// exp(high + low) for what neither overflows by more than a few bits nor vanishes.
/// \pre -746 <= high <= 711, |low| below an ulp or two of high
double ExpOf(double high, double low) noexcept {
  // high + low = n log(2) / 128 + r
  const double shifted = high * kExpInverseStep + kShift;
  const double n = shifted - kShift;
  const auto steps = static_cast<std::int64_t>(BitsOf(shifted) << 13) >> 13;
  const double r = (high - n * kExpStepHigh) - n * kExpStepLow + low;

  const ExpRow& row = kExpTable[steps & 127];
  const std::int64_t exponent = steps >> 7;
  const double r2 = r * r;
  const double terms = (kExpTerms[0] + r * kExpTerms[1]) + r2 * (kExpTerms[2] + r * kExpTerms[3]);
  const double share = row.rest + r + r2 * terms;
  // as long as the product below keeps its bits, too
  if (exponent >= -960 && exponent <= 1022) {
    const double power = FromBits(BitsOf(row.power) + (static_cast<std::uint64_t>(exponent) << 52));
    return power + power * share;
  }
  if (exponent > 0) return (row.power + row.power * share) * PowerOfTwo(static_cast<int>(exponent) - 1) * 2.0;
  const double scale = PowerOfTwo(static_cast<int>(exponent) + 1022);
  return ScaleToTiny(row.power * scale, row.power * share * scale);
}

/// x = 2^exponent z with z in [0.6875, 1.375), and the cell that z lies in.
struct LogCell {
  double z;
  int exponent;
  const LogRow& row;
};

/// \param bits  of a normal positive number, or below them by a multiple of 2^52
LogCell FindLogCell(std::uint64_t bits) noexcept {
  const std::uint64_t offset = bits - 0x3fe6000000000000ULL;
  return {FromBits(bits - (offset & 0xfff0000000000000ULL)),
          static_cast<int>(static_cast<std::int64_t>(offset) >> 52), kLogTable[(offset >> 45) & 127]};
}

/// The bits of a positive number, a subnormal one with the exponent that it would have.
std::uint64_t NormalBits(double x) noexcept {
  return x >= 0x1p-1022 ? BitsOf(x) : BitsOf(x * 0x1p52) - (std::uint64_t{52} << 52);
}

/// z/c - 1, which needs up to 54 bits.
Pair CalcRatio(double z, double inverse) noexcept {
  // 1/c has nine bits: the product with 44 others is exact
  const double z_high = FromBits(BitsOf(z) & ~std::uint64_t{511});
  return FastTwoSum(z_high * inverse - 1.0, (z - z_high) * inverse);
}

/// (log(1 + r) - r + r^2/2) / r^3
double LogTerms(double r) noexcept {
  const double r2 = r * r;
  return (kLogTerms[0] + r * kLogTerms[1]) +
         r2 * ((kLogTerms[2] + r * kLogTerms[3]) +
               r2 * ((kLogTerms[4] + r * kLogTerms[5]) + r2 * kLogTerms[6]));
}

/// log(x + low) from the bits of x.
double LogOf(std::uint64_t bits, double low) noexcept {
  const LogCell cell = FindLogCell(bits);
  const Pair ratio = CalcRatio(cell.z, cell.row.inverse);
  double rest = ratio.low;
  if (low != 0.0) rest += low * PowerOfTwo(-cell.exponent) * cell.row.inverse;
  // a low part of its own may carry the whole ratio
  const Pair r = FastTwoSum(ratio.high, rest);
  const double e = cell.exponent;
  const Pair sum = FastTwoSum(e * kLn2High + cell.row.log_high, r.high);
  const double r2 = r.high * r.high;
  return sum.high +
         (sum.low + (e * kLn2Low + cell.row.log_low + r.low) + (r2 * (r.high * LogTerms(r.high)) - 0.5 * r2));
}

/// log(x) to some 68 bits, from the bits of x.
Pair LogPairOf(std::uint64_t bits) noexcept {
  const LogCell cell = FindLogCell(bits);
  const Pair r = CalcRatio(cell.z, cell.row.inverse);
  const double e = cell.exponent;
  const Pair sum = FastTwoSum(e * kLn2High + cell.row.log_high, r.high);
  // r^2/2 with its rounding error: r_high^2/2 is exact
  const double r_high = KeepHigh(r.high), r_low = (r.high - r_high) + r.low;
  const Pair with_square = FastTwoSum(sum.high, -0.5 * r_high * r_high);
  const double cube = r.high * r.high * r.high;
  const double low =
      (e * kLn2Low + cell.row.log_low + r.low + sum.low) - 0.5 * r_low * (r.high + r_high) + with_square.low;
  return FastTwoSum(with_square.high, low + cube * LogTerms(r.high));
}

enum class Parity { kNoInteger, kOdd, kEven };

Parity FindParity(double y) noexcept {
  const std::uint64_t bits = BitsOf(y);
  const int exponent = static_cast<int>(bits >> 52 & 0x7ff) - 1023;
  if (exponent < 0) return Parity::kNoInteger;  // 0 never comes here
  if (exponent > 52) return Parity::kEven;
  const std::uint64_t unit = std::uint64_t{1} << (52 - exponent);
  if (bits & (unit - 1)) return Parity::kNoInteger;
  return exponent == 0 || (bits & unit) ? Parity::kOdd : Parity::kEven;
}

/// pow where an operand is 0, infinite or NaN, or where the result is 1.
double PowOfSpecial(double x, double y) noexcept {
  if (y == 0.0 || x == 1.0) return 1.0;
  if (x != x || y != y) return kNaN;
  const double size = std::fabs(x);
  if (std::fabs(y) == kInfinity) {
    if (size == 1.0) return 1.0;
    return (size > 1.0) == (y > 0.0) ? kInfinity : 0.0;
  }
  // x is 0 or infinite
  const double result = (size == 0.0) == (y > 0.0) ? 0.0 : kInfinity;
  return std::signbit(x) && FindParity(y) == Parity::kOdd ? -result : result;
}

}  // namespace

double Exp(double x) noexcept {
  const double size = std::fabs(x);
  if (!(size < 708.0)) {
    if (x != x) return kNaN;
    if (x > 710.0) return kInfinity;
    if (x < -746.0) return 0.0;
  }
  if (size < 0x1p-54) return 1.0 + x;
  return ExpOf(x, 0.0);
}

double Log(double x) noexcept {
  if (!(x > 0.0 && x < kInfinity)) {
    if (x == 0.0) return -kInfinity;
    return x == kInfinity ? x : kNaN;
  }
  return LogOf(NormalBits(x), 0.0);
}

double Log1p(double x) noexcept {
  if (!(x > -1.0 && x < kInfinity)) {
    if (x == -1.0) return -kInfinity;
    return x == kInfinity ? x : kNaN;
  }
  if (std::fabs(x) < 0x1p-54) return x;
  if (x > 0x1p60) return LogOf(BitsOf(x), 0.0);
  const Pair sum = TwoSum(1.0, x);
  return LogOf(BitsOf(sum.high), sum.low);
}

double Pow(double x, double y) noexcept {
  const double size = std::fabs(x), power_size = std::fabs(y);
  if (!(size > 0.0 && size < kInfinity && power_size > 0.0 && power_size < kInfinity) || x == 1.0)
    return PowOfSpecial(x, y);
  double sign = 1.0;
  if (x < 0.0) {
    const Parity parity = FindParity(y);
    if (parity == Parity::kNoInteger) return kNaN;
    if (parity == Parity::kOdd) sign = -1.0;
    if (size == 1.0) return sign;
  }
  // beyond these the logarithm of any number but 1 is too small or too large to matter
  if (power_size < 0x1p-65) return 1.0;
  if (power_size > 0x1p64) return (size > 1.0) == (y > 0.0) ? sign * kInfinity : sign * 0.0;
  const Pair log = LogPairOf(NormalBits(size));
  const Pair product = TwoProduct(y, log.high);
  if (product.high > 710.0) return sign * kInfinity;
  if (product.high < -746.0) return sign * 0.0;
  return sign * ExpOf(product.high, product.low + y * log.low);
}

}  // namespace trocar::math
