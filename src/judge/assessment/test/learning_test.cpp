// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/learning.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::assessment {
namespace {

std::vector<double> MakeCurve(double plateau, double gain, double rate, int attempts) {
  std::vector<double> values;
  for (int n = 1; n <= attempts; ++n) values.push_back(plateau + gain * std::pow(n, -rate));
  return values;
}

struct Known {
  double plateau, gain, rate;
  int attempts;
};

class NoiseFreeCurve : public testing::TestWithParam<Known> {};

TEST_P(NoiseFreeCurve, IsRecovered) {
  const Known& known = GetParam();
  const auto fit = FitLearningCurve(MakeCurve(known.plateau, known.gain, known.rate, known.attempts));
  ASSERT_TRUE(fit.ok()) << fit.error().Text();
  EXPECT_NEAR(fit->plateau, known.plateau, 1e-4 * (known.plateau + known.gain));
  EXPECT_NEAR(fit->gain, known.gain, 1e-4 * (known.plateau + known.gain));
  EXPECT_NEAR(fit->rate, known.rate, 1e-4);
  EXPECT_LT(fit->rms, 1e-6 * known.gain);
  EXPECT_FALSE(fit->is_rate_at_bound);
  EXPECT_EQ(fit->attempts, static_cast<std::size_t>(known.attempts));
}

INSTANTIATE_TEST_SUITE_P(Learning, NoiseFreeCurve,
                         testing::Values(Known{48, 250, 0.7, 30}, Known{0, 300, 0.5, 20},
                                         Known{90, 40, 1.5, 8}, Known{10, 100, 0.15, 60},
                                         Known{0.3, 0.9, 2.5, 6}));

TEST(FitLearningCurve, SaysWhenThereAreTooFewAttempts) {
  const auto fit = FitLearningCurve(MakeCurve(48, 250, 0.7, 5));
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.error().code, base::ErrorCode::kAttemptsTooFew);
  EXPECT_NE(fit.error().message.find("6"), std::string::npos);
}

TEST(FitLearningCurve, SeesNoLearningWhereValuesRise) {
  const auto fit = FitLearningCurve(std::vector<double>{10, 11, 12, 13, 14, 15, 16});
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->gain, 0);
  EXPECT_EQ(fit->rate, 0);
  EXPECT_NEAR(fit->plateau, 13, 1e-12) << "the mean";
}

TEST(FitLearningCurve, KeepsThePlateauFromFallingBelowZero) {
  // falls so straight that an unbounded plateau would be negative
  const auto fit = FitLearningCurve(std::vector<double>{60, 50, 40, 30, 20, 10, 1});
  ASSERT_TRUE(fit.ok());
  EXPECT_GE(fit->plateau, 0);
  EXPECT_GT(fit->gain, 0);
}

TEST(LearningCurve, TellsWhichAttemptReachesAValue) {
  const LearningCurve curve{40, 60, 1.0, 0, 10, false};  // 100, 70, 60, 55, 52, 50
  EXPECT_EQ(curve.AttemptsUntil(100), 1u);
  EXPECT_EQ(curve.AttemptsUntil(60), 3u);
  EXPECT_EQ(curve.AttemptsUntil(50), 6u);
  EXPECT_FALSE(curve.AttemptsUntil(40)) << "the plateau is never reached";
  EXPECT_FALSE(curve.AttemptsUntil(30));
}

// by hand, of p0 = 0.05, p1 = 0.10, alpha = beta = 0.05:
// P = ln 2, Q = ln(0.95 / 0.90), s = Q / (P + Q), h1 = -h0 = ln 19 / (P + Q)
TEST(CalcCusum, HasTheLimitsOfTheFormula) {
  const auto cusum = CalcCusum({});
  ASSERT_TRUE(cusum.ok());
  EXPECT_NEAR(cusum->step, 0.0723584, 1e-7);
  EXPECT_NEAR(cusum->h1, 3.9405544, 1e-6);
  EXPECT_NEAR(cusum->h0, -3.9405544, 1e-6);
  EXPECT_EQ(cusum->verdict, CusumVerdict::kUndecided);
}

TEST(CalcCusum, AddsForFailuresAndTakesOffForSuccesses) {
  const auto cusum = CalcCusum({false, true, false});
  ASSERT_TRUE(cusum.ok());
  ASSERT_EQ(cusum->values.size(), 3u);
  EXPECT_NEAR(cusum->values[0], -0.0723584, 1e-7);
  EXPECT_NEAR(cusum->values[1], 0.8552832, 1e-6);
  EXPECT_NEAR(cusum->values[2], 0.7829249, 1e-6);
}

TEST(CalcCusum, CallsARowOfSuccessesAcceptableAfterTheFiftyFifth) {
  // 54 s = 3.907 < 3.941 <= 55 s = 3.980
  const auto before = CalcCusum(std::vector<bool>(54, false)),
             after = CalcCusum(std::vector<bool>(55, false));
  EXPECT_EQ(before->verdict, CusumVerdict::kUndecided);
  EXPECT_EQ(after->verdict, CusumVerdict::kAcceptable);
  EXPECT_EQ(after->acceptable_at, 54u);
  EXPECT_FALSE(after->unacceptable_at);
}

TEST(CalcCusum, CallsFiveFailuresUnacceptable) {
  // 4 (1 - s) = 3.711 < 3.941 <= 5 (1 - s) = 4.638
  EXPECT_EQ(CalcCusum(std::vector<bool>(4, true))->verdict, CusumVerdict::kUndecided);
  const auto cusum = CalcCusum(std::vector<bool>(5, true));
  EXPECT_EQ(cusum->verdict, CusumVerdict::kUnacceptable);
  EXPECT_EQ(cusum->unacceptable_at, 4u);
}

TEST(CalcCusum, UsesEachChanceForItsOwnLimit) {
  const auto cusum = CalcCusum({}, {0.1, 0.3, 0.01, 0.2});
  ASSERT_TRUE(cusum.ok());
  const double p = std::log(3.0), q = std::log(0.9 / 0.7);
  EXPECT_NEAR(cusum->h1, std::log(0.8 / 0.01) / (p + q), 1e-12);
  EXPECT_NEAR(cusum->h0, -std::log(0.99 / 0.2) / (p + q), 1e-12);
}

TEST(CalcCusum, RefusesSettingsOutOfOrder) {
  for (const CusumSettings& wrong :
       {CusumSettings{0.1, 0.05, 0.05, 0.05}, CusumSettings{0, 0.1, 0.05, 0.05},
        CusumSettings{0.05, 1, 0.05, 0.05}, CusumSettings{0.05, 0.1, 0, 0.05},
        CusumSettings{0.05, 0.1, 0.05, 0.5}, CusumSettings{NAN, 0.1, 0.05, 0.05}}) {
    const auto cusum = CalcCusum({true}, wrong);
    ASSERT_FALSE(cusum.ok());
    EXPECT_EQ(cusum.error().code, base::ErrorCode::kProficiencyInvalid);
  }
}

TEST(CalcPercentile, CountsTiesHalfAndKnowsWhichWayIsBetter) {
  const std::vector<double> group = {10, 20, 30, 40};
  EXPECT_DOUBLE_EQ(*CalcPercentile(25, group, Better::kHigher), 50);
  EXPECT_DOUBLE_EQ(*CalcPercentile(30, group, Better::kHigher), 62.5);
  EXPECT_DOUBLE_EQ(*CalcPercentile(10, group, Better::kLower), 87.5);
  EXPECT_DOUBLE_EQ(*CalcPercentile(5, group, Better::kLower), 100);
  EXPECT_DOUBLE_EQ(*CalcPercentile(5, group, Better::kHigher), 0);
  EXPECT_EQ(CalcPercentile(5, {}, Better::kLower).error().code, base::ErrorCode::kAttemptsTooFew);
}

// by hand: n = 5 in falling order has S = -10, variance 5 4 15 / 18, z = 9 / sqrt(16.667), p = 0.0275
TEST(CalcTrend, FindsARowThatFalls) {
  const auto trend = CalcTrend(std::vector<double>{50, 44, 41, 35, 30}, Better::kLower);
  ASSERT_TRUE(trend.ok());
  EXPECT_NEAR(trend->probability, 0.0274863, 1e-6);
  EXPECT_DOUBLE_EQ(trend->slope, -5);
  EXPECT_EQ(trend->verdict, TrendVerdict::kImproving);
  EXPECT_EQ(CalcTrend(std::vector<double>{50, 44, 41, 35, 30}, Better::kHigher)->verdict,
            TrendVerdict::kWorsening);
}

// n values that rise have S = n (n - 1) / 2 and variance n (n - 1) (2 n + 5) / 18: near and far tails of the normal distribution
TEST(CalcTrend, GivesTheNormalDistributionsTails) {
  for (int n = 5; n <= 60; ++n) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back(i);
    const double pairs = 0.5 * n * (n - 1), z = (pairs - 1) / std::sqrt(pairs * (2 * n + 5) / 9);
    const double expected = std::erfc(z / std::sqrt(2.0));
    EXPECT_NEAR(CalcTrend(values, Better::kLower)->probability, expected, 1e-12 * expected) << n;
  }
}

TEST(CalcTrend, FindsNoneInAShuffledRowOrInEqualValues) {
  EXPECT_EQ(CalcTrend(std::vector<double>{3, 1, 4, 1, 5}, Better::kLower)->verdict, TrendVerdict::kNone);
  const auto equal = CalcTrend(std::vector<double>{7, 7, 7, 7, 7}, Better::kLower);
  EXPECT_EQ(equal->slope, 0);
  EXPECT_EQ(equal->probability, 1);
  EXPECT_EQ(CalcTrend(std::vector<double>{1, 2, 3, 4}, Better::kLower).error().code,
            base::ErrorCode::kAttemptsTooFew);
}

}  // namespace
}  // namespace trocar::assessment
