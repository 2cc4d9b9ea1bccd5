// SPDX-License-Identifier: Apache-2.0
// Worked examples, and cases that can be counted by hand.
#include "trocar/bench/validity_statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "trocar/math/random.h"

namespace trocar::bench {
namespace {

TEST(Auc, CountsPairsByHand) {
  const std::array<double, 3> worse = {3, 4, 5}, better = {1, 2, 3.5};
  // of nine pairs eight are greater
  EXPECT_NEAR(CalcAuc(worse, better), 8.0 / 9, 1e-12);
  EXPECT_NEAR(CalcAuc(better, worse), 1.0 / 9, 1e-12);
  const std::array<double, 2> same = {1, 1};
  EXPECT_EQ(CalcAuc(same, same), 0.5);
  EXPECT_EQ(CalcAuc({}, same), 0.5);
}

TEST(EffectSize, IsCohensD) {
  const std::array<double, 4> a = {2, 4, 6, 8}, b = {1, 3, 5, 7};
  // both have the variance 20/3
  EXPECT_NEAR(*CalcEffectSize(a, b), 1 / std::sqrt(20.0 / 3), 1e-12);
  const std::array<double, 2> flat = {1, 1};
  EXPECT_FALSE(CalcEffectSize(flat, flat).has_value());
}

TEST(Apart, NeedsAGapBetweenTheRanges) {
  const std::array<double, 2> low = {1, 2}, high = {3, 4}, between = {1.5, 3.5}, touching = {2, 5};
  EXPECT_TRUE(AreApart(low, high));
  EXPECT_TRUE(AreApart(high, low));
  EXPECT_FALSE(AreApart(low, between));
  EXPECT_FALSE(AreApart(low, touching));
  EXPECT_FALSE(AreApart(low, {}));
}

// Six people judged four times: Shrout and Fleiss 1979, table 2; they give ICC(1,1) = 0.17.
TEST(IntraclassCorrelation, IsThatOfShroutAndFleiss) {
  const std::vector<std::vector<double>> ratings = {{9, 2, 5, 8}, {6, 1, 3, 2},  {8, 4, 6, 8},
                                                    {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  EXPECT_NEAR(*CalcIntraclassCorrelation(ratings), 0.166, 5e-4);
  // alpha is their ICC(3,k), 0.91
  EXPECT_NEAR(*CalcCronbachAlpha(ratings), 0.909, 5e-4);
}

TEST(IntraclassCorrelation, IsOneWhereAttemptsRepeatAndAbsentWithoutATable) {
  EXPECT_NEAR(*CalcIntraclassCorrelation({{1, 1}, {2, 2}, {5, 5}}), 1, 1e-12);
  EXPECT_FALSE(CalcIntraclassCorrelation({{1, 2}}).has_value());
  EXPECT_FALSE(CalcIntraclassCorrelation({{1}, {2}}).has_value());
  EXPECT_FALSE(CalcIntraclassCorrelation({{1, 2}, {2}}).has_value());
  EXPECT_FALSE(CalcIntraclassCorrelation({{1, 1}, {1, 1}}).has_value());
}

TEST(RankCorrelation, FollowsOrderAndSharesTies) {
  const std::array<double, 5> a = {1, 2, 3, 4, 5}, square = {1, 4, 9, 16, 25}, down = {9, 7, 5, 3, 1};
  EXPECT_NEAR(*CalcRankCorrelation(a, square), 1, 1e-12);
  EXPECT_NEAR(*CalcRankCorrelation(a, down), -1, 1e-12);
  const std::array<double, 5> tied = {1, 2, 2, 4, 5};
  // ranks 1, 2.5, 2.5, 4, 5: Pearson of the ranks by hand
  EXPECT_NEAR(*CalcRankCorrelation(a, tied), 9.5 / std::sqrt(10 * 9.5), 1e-12);
  const std::array<double, 5> flat = {3, 3, 3, 3, 3};
  EXPECT_FALSE(CalcRankCorrelation(a, flat).has_value());
}

TEST(Clusters, JoinWhatSaysTheSameInEitherSense) {
  math::Random random(3);
  std::vector<std::vector<double>> variables(5, std::vector<double>(200));
  for (std::size_t i = 0; i < 200; ++i) {
    const double x = random.Uniform();
    variables[0][i] = x;
    variables[1][i] = random.Uniform();
    variables[2][i] = std::exp(3 * x);
    variables[3][i] = -x + 0.02 * random.Uniform();
    variables[4][i] = random.Uniform();
  }
  const auto clusters = FindClusters(variables, 0.9);
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_EQ(clusters[0], (std::vector<std::size_t>{0, 2, 3}));
}

}  // namespace
}  // namespace trocar::bench
