// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/to_integer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace trocar::base {
namespace {

template <typename Integer>
class ToIntegerTest : public testing::Test {};
using Integers = testing::Types<signed char, char, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                                std::uint32_t, std::int64_t, std::uint64_t, long, long long>;
TYPED_TEST_SUITE(ToIntegerTest, Integers);

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TYPED_TEST(ToIntegerTest, HoldsTheRangesEnds) {
  using Limits = std::numeric_limits<TypeParam>;
  const double beyond = std::ldexp(1.0, Limits::digits);  // one more than the highest
  for (const double x :
       {beyond, std::nextafter(beyond, kInfinity), 2 * beyond, 0x1p31, 0x1p63, 0x1p64, 1e300, kInfinity}) {
    if (x < beyond) continue;
    EXPECT_EQ(TruncateTo<TypeParam>(x), Limits::max()) << x;
    EXPECT_EQ(FloorTo<TypeParam>(x), Limits::max()) << x;
    EXPECT_EQ(CeilTo<TypeParam>(x), Limits::max()) << x;
    EXPECT_EQ(RoundTo<TypeParam>(x), Limits::max()) << x;
  }
  // the lowest itself, and what lies below it; unsigned: a negative number is 0 and does not come round
  const double lowest = static_cast<double>(Limits::min());
  for (const double x : {lowest, lowest - 0.25, lowest - 1, std::nextafter(lowest, -kInfinity), 4 * lowest,
                         -0x1p63, -0x1p64, -1e300, -kInfinity}) {
    if (x > lowest) continue;
    EXPECT_EQ(TruncateTo<TypeParam>(x), Limits::min()) << x;
    EXPECT_EQ(FloorTo<TypeParam>(x), Limits::min()) << x;
    EXPECT_EQ(CeilTo<TypeParam>(x), Limits::min()) << x;
    EXPECT_EQ(RoundTo<TypeParam>(x), Limits::min()) << x;
  }
}

// the number next to the range's end that a double holds
TYPED_TEST(ToIntegerTest, IsExactUpToTheRangesEnds) {
  using Limits = std::numeric_limits<TypeParam>;
  const double beyond = std::ldexp(1.0, Limits::digits);
  const double highest = Limits::digits <= 53 ? beyond - 1 : std::nextafter(beyond, 0.0);
  const auto expected = static_cast<TypeParam>(
      Limits::digits <= 53 ? Limits::max()
                           : Limits::max() - ((std::uint64_t{1} << (Limits::digits - 53)) - 1));
  EXPECT_EQ(TruncateTo<TypeParam>(highest), expected);
  EXPECT_EQ(FloorTo<TypeParam>(highest), expected);
  EXPECT_EQ(CeilTo<TypeParam>(highest), expected);
  EXPECT_EQ(RoundTo<TypeParam>(highest), expected);
  EXPECT_EQ(TruncateTo<TypeParam>(std::nextafter(beyond, 0.0)), expected);
}

TYPED_TEST(ToIntegerTest, TakesWhatIsNotANumberForZero) {
  for (const double nan :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::quiet_NaN(),
        std::numeric_limits<double>::signaling_NaN()}) {
    EXPECT_EQ(TruncateTo<TypeParam>(nan), 0);
    EXPECT_EQ(FloorTo<TypeParam>(nan), 0);
    EXPECT_EQ(CeilTo<TypeParam>(nan), 0);
    EXPECT_EQ(RoundTo<TypeParam>(nan), 0);
  }
}

TEST(ToInteger, RoundsEachInItsWay) {
  struct Case {
    double x;
    int truncated, down, up, nearest;
  };
  for (const Case& c :
       {Case{0.0, 0, 0, 0, 0}, Case{-0.0, 0, 0, 0, 0}, Case{0.5, 0, 0, 1, 1}, Case{-0.5, 0, -1, 0, -1},
        Case{1.5, 1, 1, 2, 2}, Case{-1.5, -1, -2, -1, -2}, Case{2.5, 2, 2, 3, 3}, Case{-2.5, -2, -3, -2, -3},
        Case{2.9, 2, 2, 3, 3}, Case{-2.9, -2, -3, -2, -3},
        // next to a half: x + 0.5 would be rounded to 1
        Case{0.49999999999999994, 0, 0, 1, 0}, Case{-0.49999999999999994, 0, -1, 0, 0},
        Case{0x1p-1074, 0, 0, 1, 0}, Case{-0x1p-1074, 0, -1, 0, 0},
        Case{2147483646.5, 2147483646, 2147483646, 2147483647, 2147483647},
        Case{2147483647.5, 2147483647, 2147483647, 2147483647, 2147483647},
        Case{-2147483648.5, -2147483647 - 1, -2147483647 - 1, -2147483647 - 1, -2147483647 - 1}}) {
    EXPECT_EQ(TruncateTo<int>(c.x), c.truncated) << c.x;
    EXPECT_EQ(FloorTo<int>(c.x), c.down) << c.x;
    EXPECT_EQ(CeilTo<int>(c.x), c.up) << c.x;
    EXPECT_EQ(RoundTo<int>(c.x), c.nearest) << c.x;
  }
  EXPECT_EQ(TruncateTo<unsigned>(-0.9), 0u);
  EXPECT_EQ(CeilTo<unsigned>(-0.9), 0u);
  EXPECT_EQ(RoundTo<std::uint8_t>(254.5), 255);
  EXPECT_EQ(RoundTo<std::uint8_t>(255.5), 255);
  EXPECT_EQ(RoundTo<std::int64_t>(4503599627370495.5), 4503599627370496);  // the largest half
  EXPECT_EQ(RoundTo<std::int64_t>(9007199254740993.0), 9007199254740992);
  static_assert(TruncateTo<int>(2.9) == 2 && TruncateTo<int>(1e10) == 2147483647);
}

// where the result fits, these are the conversions of C++ and the functions of the C library
TEST(ToInteger, AgreesWithTheCLibraryInRange) {
  std::mt19937_64 random(67);
  for (int i = 0; i < 200000; ++i) {
    // every magnitude below 2^62, near halves too
    const std::uint64_t word = random();
    double x = std::ldexp(static_cast<double>(word >> 11), -static_cast<int>(word & 127) + 9);
    if (i % 3 == 0) x = std::floor(x) + 0.5;
    if ((word & 1024) != 0) x = -x;
    if (!(std::fabs(x) < 0x1p62)) continue;
    ASSERT_EQ(TruncateTo<std::int64_t>(x), static_cast<std::int64_t>(x)) << x;
    ASSERT_EQ(FloorTo<std::int64_t>(x), static_cast<std::int64_t>(std::floor(x))) << x;
    ASSERT_EQ(CeilTo<std::int64_t>(x), static_cast<std::int64_t>(std::ceil(x))) << x;
    ASSERT_EQ(RoundTo<std::int64_t>(x), std::llround(x)) << x;
    if (!(std::fabs(x) < 0x1p30)) continue;
    ASSERT_EQ(TruncateTo<int>(x), static_cast<int>(x)) << x;
    ASSERT_EQ(RoundTo<int>(x), std::lround(x)) << x;
    if (x >= 0) {
      ASSERT_EQ(TruncateTo<unsigned>(x), static_cast<unsigned>(x)) << x;
    }
  }
}

}  // namespace
}  // namespace trocar::base
