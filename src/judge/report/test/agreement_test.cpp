// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace trocar::report {
namespace {

// Shrout and Fleiss 1979, table 2: six subjects, four judges.
const std::vector<double> kShroutFleiss = {9, 2, 5, 8, 6,  1, 3, 2, 8, 4, 6, 8,
                                           7, 1, 2, 6, 10, 5, 6, 9, 6, 2, 4, 7};

TEST(CalcAgreement, ReproducesShroutAndFleiss) {
  const auto agreement = CalcAgreement(kShroutFleiss, 4);
  ASSERT_TRUE(agreement.ok()) << agreement.error().Text();
  EXPECT_EQ(agreement->subjects, 6u);
  // table 4 gives two digits
  EXPECT_NEAR(agreement->one_random.value, 0.17, 0.005);
  EXPECT_NEAR(agreement->two_random.value, 0.29, 0.005);
  EXPECT_NEAR(agreement->three_fixed.value, 0.71, 0.005);
  EXPECT_NEAR(agreement->one_random_mean.value, 0.44, 0.005);
  EXPECT_NEAR(agreement->two_random_mean.value, 0.62, 0.005);
  EXPECT_NEAR(agreement->three_fixed_mean.value, 0.91, 0.005);
}

// The same table's intervals, as McGraw and Wong's formulas give them; published with R's psych::ICC on these data.
TEST(CalcAgreement, GivesThePublishedIntervals) {
  const auto agreement = CalcAgreement(kShroutFleiss, 4, 0.95);
  ASSERT_TRUE(agreement.ok());
  const auto expect = [](const Icc& icc, double low, double high) {
    EXPECT_NEAR(icc.low, low, 0.005);
    EXPECT_NEAR(icc.high, high, 0.005);
  };
  expect(agreement->one_random, -0.133, 0.72);
  expect(agreement->two_random, 0.019, 0.76);
  expect(agreement->three_fixed, 0.342, 0.95);
  expect(agreement->one_random_mean, -0.884, 0.91);
  expect(agreement->two_random_mean, 0.071, 0.93);
  expect(agreement->three_fixed_mean, 0.676, 0.99);
}

// Raters who differ by a constant are consistent, and do not agree.
TEST(CalcAgreement, TellsConsistencyFromAgreement) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<double> ratings;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 3; ++j) ratings.push_back(i % 5 + 3.0 * j + noise(random));
  }
  const auto agreement = CalcAgreement(ratings, 3);
  ASSERT_TRUE(agreement.ok());
  EXPECT_GT(agreement->three_fixed.value, 0.98);
  EXPECT_LT(agreement->two_random.value, 0.3);
}

// Of 2000 samples of a known model the interval holds the truth about as often as it says.
TEST(CalcAgreement, IntervalHoldsTheTruthAsOftenAsItSays) {
  const double truth = 4.0 / (4.0 + 1.0);  // variance of subjects, and of the rest
  std::mt19937 random(11);
  std::normal_distribution<double> subject(0, 2), rest(0, 1);
  int held = 0;
  constexpr int kSamples = 2000;
  for (int sample = 0; sample < kSamples; ++sample) {
    std::vector<double> ratings;
    for (int i = 0; i < 15; ++i) {
      const double own = subject(random);
      for (int j = 0; j < 3; ++j) ratings.push_back(own + rest(random));
    }
    const auto agreement = CalcAgreement(ratings, 3, 0.9);
    ASSERT_TRUE(agreement.ok());
    held += agreement->three_fixed.low <= truth && truth <= agreement->three_fixed.high ? 1 : 0;
  }
  EXPECT_NEAR(held / static_cast<double>(kSamples), 0.9, 0.025);
}

TEST(CalcAgreement, RefusesWhatItCannotTell) {
  const auto code = [](const std::vector<double>& ratings, std::size_t raters) {
    const auto agreement = CalcAgreement(ratings, raters);
    return agreement.ok() ? base::ErrorCode::kNone : agreement.error().code;
  };
  EXPECT_EQ(code({1, 2, 3, 4}, 1), base::ErrorCode::kRatingInvalid);
  EXPECT_EQ(code({1, 2}, 2), base::ErrorCode::kRatingInvalid);
  EXPECT_EQ(code({1, 2, 3, 4, 5}, 2), base::ErrorCode::kRatingInvalid);
  EXPECT_EQ(code({3, 3, 3, 3}, 2), base::ErrorCode::kRatingInvalid);
  EXPECT_EQ(code({1, 2, 3, std::numeric_limits<double>::quiet_NaN()}, 2), base::ErrorCode::kRatingInvalid);
}

TEST(DescribeAgreement, SaysItInWords) {
  EXPECT_EQ(DescribeAgreement(0.29), "poor");
  EXPECT_EQ(DescribeAgreement(0.62), "moderate");
  EXPECT_EQ(DescribeAgreement(0.8), "good");
  EXPECT_EQ(DescribeAgreement(0.91), "excellent");
}

}  // namespace
}  // namespace trocar::report
