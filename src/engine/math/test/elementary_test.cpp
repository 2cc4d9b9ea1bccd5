// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/elementary.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <algorithm>
#include <cmath>
#include <ios>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>

#include "elementary_samples.h"

namespace trocar::math {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kAllowedError = 1.0;  // [ulp], what the header promises

/// Values by MPFR, correctly rounded to 120 bits, and how far a double lies from them.
class Reference {
 public:
  Reference() {
    mpfr_inits2(53, x_, y_, nullptr);
    mpfr_inits2(120, exact_, difference_, nullptr);
  }
  ~Reference() { mpfr_clears(x_, y_, exact_, difference_, nullptr); }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  /// Error of `value` [units in the last place of the exact result]; infinite where NaN, infinity or a sign is wrong.
  double CalcError(const ElementaryFunction& function, const Arguments& a, double value) {
    mpfr_set_d(x_, a.x, MPFR_RNDN);
    mpfr_set_d(y_, a.y, MPFR_RNDN);
    Evaluate(function.name);
    if (mpfr_nan_p(exact_) || std::isnan(value)) return mpfr_nan_p(exact_) && std::isnan(value) ? 0.0 : kInf;
    if ((mpfr_signbit(exact_) != 0) != std::signbit(value)) return kInf;
    if (mpfr_inf_p(exact_)) return std::isinf(value) ? 0.0 : kInf;
    if (mpfr_zero_p(exact_)) return value == 0.0 ? 0.0 : kInf;
    const long exponent = mpfr_get_exp(exact_);
    if (std::isinf(value)) {
      if (exponent > 1024) return 0.0;
      mpfr_set_si_2exp(difference_, value > 0 ? 1 : -1, 1024, MPFR_RNDN);
    } else {
      mpfr_set_d(difference_, value, MPFR_RNDN);
    }
    mpfr_sub(difference_, difference_, exact_, MPFR_RNDN);
    mpfr_mul_2si(difference_, difference_, -std::max(exponent - 53, -1074L), MPFR_RNDN);
    return std::fabs(mpfr_get_d(difference_, MPFR_RNDN));
  }

 private:
  void Evaluate(std::string_view name) {
    if (name == "Sin") mpfr_sin(exact_, x_, MPFR_RNDN);
    if (name == "Cos") mpfr_cos(exact_, x_, MPFR_RNDN);
    if (name == "Tan") mpfr_tan(exact_, x_, MPFR_RNDN);
    if (name == "Asin") mpfr_asin(exact_, x_, MPFR_RNDN);
    if (name == "Acos") mpfr_acos(exact_, x_, MPFR_RNDN);
    if (name == "Atan2") mpfr_atan2(exact_, y_, x_, MPFR_RNDN);
    if (name == "Exp") mpfr_exp(exact_, x_, MPFR_RNDN);
    if (name == "Log") mpfr_log(exact_, x_, MPFR_RNDN);
    if (name == "Log1p") mpfr_log1p(exact_, x_, MPFR_RNDN);
    if (name == "Pow") mpfr_pow(exact_, x_, y_, MPFR_RNDN);
    if (name == "Cbrt") mpfr_cbrt(exact_, x_, MPFR_RNDN);
    if (name == "Hypot") mpfr_hypot(exact_, x_, y_, MPFR_RNDN);
  }

  mpfr_t x_, y_, exact_, difference_;
};

std::string DescribeCase(const ElementaryFunction& function, const Arguments& a, double value) {
  std::ostringstream text;
  text << function.name << " of x = " << std::hexfloat << a.x << ", y = " << a.y << " gave " << value;
  return text.str();
}

/// The largest error over drawn arguments has to be allowed; it becomes a property of the test.
void CheckErrors(const ElementaryFunction& function, std::uint64_t seed, int count) {
  Reference reference;
  Random random(seed);
  double worst = 0.0;
  for (int i = 0; i < count; ++i) {
    const Arguments a = function.draw(random);
    const double value = function.value(a), error = reference.CalcError(function, a, value);
    if (error <= worst) continue;
    worst = error;
    ASSERT_LE(error, kAllowedError) << DescribeCase(function, a, value) << ", seed " << seed << ", argument "
                                    << i;
  }
  testing::Test::RecordProperty("largest_error_ulp", std::to_string(worst));
}

class Elementary : public testing::TestWithParam<ElementaryFunction> {};
class ElementarySlow : public testing::TestWithParam<ElementaryFunction> {};

std::string NameOf(const testing::TestParamInfo<ElementaryFunction>& info) {
  return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Function, Elementary, testing::ValuesIn(kElementaryFunctions), NameOf);
INSTANTIATE_TEST_SUITE_P(Function, ElementarySlow, testing::ValuesIn(kElementaryFunctions), NameOf);

TEST_P(Elementary, IsWithinOneUnitInTheLastPlace) {
  CheckErrors(GetParam(), 1, 200'000);
}

TEST_P(ElementarySlow, IsWithinOneUnitInTheLastPlace) {
  CheckErrors(GetParam(), 2, 10'000'000);
}

// MPFR follows Annex F in all special values.
TEST_P(Elementary, HasTheSpecialValuesOfAnnexF) {
  Reference reference;
  for (const double x : kSpecialNumbers) {
    for (const double y : kSpecialNumbers) {
      for (const Arguments a : {Arguments{x, y}, Arguments{-x, y}, Arguments{x, -y}, Arguments{-x, -y}}) {
        const double value = GetParam().value(a);
        EXPECT_LE(reference.CalcError(GetParam(), a, value), kAllowedError)
            << DescribeCase(GetParam(), a, value);
      }
    }
  }
}

// A negative control: a value beside the right one, a wrong sign and a number for NaN are noticed.
TEST(ElementaryReference, NoticesWrongValues) {
  Reference reference;
  const ElementaryFunction& sine = kElementaryFunctions[0];
  const double right = Sin(0.7);
  EXPECT_LE(reference.CalcError(sine, {0.7}, right), kAllowedError);
  EXPECT_GT(reference.CalcError(sine, {0.7}, std::nextafter(std::nextafter(right, 1.0), 1.0)), kAllowedError);
  EXPECT_EQ(reference.CalcError(sine, {-0.0}, 0.0), kInf);
  EXPECT_EQ(reference.CalcError(sine, {kInf}, 0.0), kInf);
}

// The same constants hold with every compiler, optimisation and processor; tests/bits compares more of them.
TEST(ElementaryBits, AreTheSameEverywhere) {
  struct Expected {
    const char* name;
    const char* hash;
  };
  constexpr Expected kExpected[] = {
      {"Sin", "8e6ca3a6a9c4a5a1"},  {"Cos", "c20dfdf5c775ba3b"},  {"Tan", "01f81df764d84286"},
      {"Asin", "1f190090c938bab9"}, {"Acos", "032fbad562a17d02"}, {"Atan2", "f2a205ea84c5d5d1"},
      {"Exp", "f57514a1546e4c48"},  {"Log", "cb2f9e2a86e6d05e"},  {"Log1p", "7f0df67964f2671a"},
      {"Pow", "8b99030ded7d119f"},  {"Cbrt", "8c9be12e485c716c"}, {"Hypot", "1db7c15f51e97171"},
  };
  ASSERT_EQ(std::size(kExpected), std::size(kElementaryFunctions));
  for (std::size_t i = 0; i < std::size(kExpected); ++i) {
    EXPECT_STREQ(kElementaryFunctions[i].name, kExpected[i].name);
    EXPECT_EQ(base::HashText(HashValues(kElementaryFunctions[i], kHashedArguments)), kExpected[i].hash)
        << kExpected[i].name;
  }
}

TEST(SinCos, GivesTheBitsOfBoth) {
  Random random(3);
  for (int i = 0; i < 100'000; ++i) {
    const double x = DrawAngle(random).x;
    const SineCosine both = SinCos(x);
    ASSERT_EQ(both.sine, Sin(x)) << std::hexfloat << x;
    ASSERT_EQ(both.cosine, Cos(x)) << std::hexfloat << x;
  }
}

TEST(Sin, KnowsTheArgumentNearestToAMultipleOfPi) {
  // 6381956970095103 * 2^797 (Muller, "Elementary Functions", chapter 11): its cosine is -4.687e-19
  const double x = 6381956970095103.0 * 0x1p797;
  EXPECT_EQ(std::fabs(Sin(x)), 1.0);
  EXPECT_NEAR(Cos(x), -4.6871659242546276e-19, 1e-34);
}

TEST(Sin, IsOddAndCosineEven) {
  Random random(4);
  for (int i = 0; i < 10'000; ++i) {
    const double x = DrawAngle(random).x;
    ASSERT_EQ(Sin(-x), -Sin(x)) << std::hexfloat << x;
    ASSERT_EQ(Cos(-x), Cos(x)) << std::hexfloat << x;
  }
}

// What Annex F says, in the words of a few of its lines.
TEST(Pow, OfSpecialOperands) {
  EXPECT_EQ(Pow(kNoNumber, 0.0), 1.0);
  EXPECT_EQ(Pow(1.0, kNoNumber), 1.0);
  EXPECT_EQ(Pow(-1.0, kInf), 1.0);
  EXPECT_EQ(Pow(-0.0, -3.0), -kInf);
  EXPECT_EQ(Pow(-0.0, -2.0), kInf);
  EXPECT_EQ(Pow(-kInf, 3.0), -kInf);
  EXPECT_EQ(Pow(0.5, -kInf), kInf);
  EXPECT_TRUE(std::isnan(Pow(-2.0, 0.5)));
  EXPECT_TRUE(std::signbit(Pow(-2.0, -1081.0)));
}

TEST(Pow, OfExactResultsIsExact) {
  for (int base = -20; base <= 20; ++base) {
    double product = 1.0;
    for (int power = 0; power <= 12; ++power, product *= base) {
      if (std::fabs(product) > 0x1p53) break;
      EXPECT_EQ(Pow(base, power), product) << base << " to the power " << power;
    }
  }
}

TEST(Cbrt, OfCubesIsExact) {
  for (int i = -2000; i <= 2000; ++i) EXPECT_EQ(Cbrt(1.0 * i * i * i), i);
}

TEST(Hypot, OfPythagoreanTriplesIsExact) {
  for (const double scale : {0x1p-1070, 0x1p-600, 1.0, 0x1p600, 0x1p1010}) {
    EXPECT_EQ(Hypot(3 * scale, -4 * scale), 5 * scale);
    EXPECT_EQ(Hypot(12 * scale, 5 * scale), 13 * scale);
  }
  EXPECT_EQ(Hypot(kNoNumber, -kInf), kInf);
}

TEST(Atan2, OfAxesAndDiagonals) {
  EXPECT_EQ(Atan2(0.0, -0.0), std::numbers::pi);
  EXPECT_EQ(Atan2(-0.0, -1.0), -std::numbers::pi);
  EXPECT_EQ(Atan2(-1.0, 0.0), -std::numbers::pi / 2);
  EXPECT_EQ(Atan2(1.0, 1.0), std::numbers::pi / 4);
  EXPECT_EQ(Atan2(kInf, -kInf), 3 * std::numbers::pi / 4);
}

TEST(Exp, AtTheEndsOfTheRange) {
  EXPECT_EQ(Exp(-0.0), 1.0);
  EXPECT_TRUE(std::isfinite(Exp(709.78271289338397)));
  EXPECT_EQ(Exp(709.78271289338409), kInf);
  EXPECT_EQ(Exp(-745.13321910194110), 0x1p-1074);
  EXPECT_EQ(Exp(-745.13321910194122), 0.0);
}

}  // namespace
}  // namespace trocar::math
