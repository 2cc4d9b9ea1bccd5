// SPDX-License-Identifier: Apache-2.0
#include "band_matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace trocar::rod {
namespace {

constexpr std::size_t kRows = 40;

/// B B^T + I of a banded B would fill twice the band; so a random band whose diagonal outweighs it.
std::vector<double> MakeBand(double diagonal) {
  std::mt19937 random(3);
  std::vector<double> band(kRows * kBandWidth);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = row - std::min(row, kBandWidth - 1); column < row; ++column)
      band[BandAt(row, column)] = static_cast<double>(random()) / 4294967295.0 - 0.5;
    band[BandAt(row, row)] = diagonal;
  }
  return band;
}

double EntryOf(const std::vector<double>& band, std::size_t row, std::size_t column) {
  if (column > row) std::swap(row, column);
  return row - column < kBandWidth ? band[BandAt(row, column)] : 0.0;
}

TEST(BandMatrix, SolvesAsTheWholeMatrixWould) {
  const std::vector<double> band = MakeBand(8.0);
  std::vector<double> expected(kRows), x(kRows);
  for (std::size_t i = 0; i < kRows; ++i) expected[i] = std::sqrt(static_cast<double>(i)) - 2.0;
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < kRows; ++column)
      x[row] += EntryOf(band, row, column) * expected[column];
  }
  std::vector<double> factor = band;
  ASSERT_TRUE(FactorBand(factor));
  SolveBand(factor, x);
  for (std::size_t i = 0; i < kRows; ++i) EXPECT_NEAR(x[i], expected[i], 1e-12);
}

TEST(BandMatrix, KnowsWhatIsNotPositiveDefinite) {
  std::vector<double> band = MakeBand(0.5);
  EXPECT_FALSE(FactorBand(band));
  // singular: two equal rows
  std::vector<double> equal(2 * kBandWidth);
  equal[BandAt(0, 0)] = equal[BandAt(1, 0)] = equal[BandAt(1, 1)] = 3.0;
  EXPECT_FALSE(FactorBand(equal));
  equal[BandAt(1, 1)] = 3.1;
  EXPECT_TRUE(FactorBand(equal));
}

}  // namespace
}  // namespace trocar::rod
