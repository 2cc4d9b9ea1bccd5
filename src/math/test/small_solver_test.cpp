// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/small_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/math/random.h"

namespace trocar::math {
namespace {

constexpr std::size_t kMost = 5;
using Matrix = SmallMatrix<kMost>;
using Vector = SmallVector<kMost>;

/// Largest |a x - b|.
double FindError(const Matrix& a, const Vector& b, std::size_t count, const Vector& x) {
  double worst = 0;
  for (std::size_t row = 0; row < count; ++row) {
    double sum = -b[row];
    for (std::size_t k = 0; k < count; ++k) sum += a[row][k] * x[k];
    worst = std::max(worst, std::fabs(sum));
  }
  return worst;
}

TEST(SolveSmall, SolvesWhatItIsGiven) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 1 + trial % kMost;
    Matrix a{}, gram{};
    Vector b{}, x{};
    for (std::size_t i = 0; i < count; ++i) {
      b[i] = random.Uniform(-1, 1);
      for (std::size_t j = 0; j < count; ++j) a[i][j] = random.Uniform(-1, 1);
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        gram[i][j] = i == j ? 0.1 : 0;
        for (std::size_t k = 0; k < count; ++k) gram[i][j] += a[k][i] * a[k][j];
      }
    }
    ASSERT_TRUE((SolveSmall<Pivots::kRows>(a, b, count, x)));
    EXPECT_LT(FindError(a, b, count, x), 1e-9) << "seed 5, trial " << trial;
    ASSERT_TRUE((SolveSmall<Pivots::kNone>(gram, b, count, x)));
    EXPECT_LT(FindError(gram, b, count, x), 1e-9) << "seed 5, trial " << trial;
  }
}

TEST(SolveSmall, PivotsWhereItIsTold) {
  const Matrix swapped = {{{0, 2}, {4, 0}}};
  Vector x{7, 7, 7};
  ASSERT_TRUE((SolveSmall<Pivots::kRows>(swapped, Vector{2, 8}, 2, x)));
  EXPECT_EQ(x[0], 2);
  EXPECT_EQ(x[1], 1);
  EXPECT_EQ(x[2], 7) << "what stands behind stays";
  EXPECT_FALSE((SolveSmall<Pivots::kRows>(Matrix{}, Vector{1}, 1, x)));
}

// a constraint that nothing answers takes no share, and leaves the others theirs
TEST(SolveSmall, WithoutPivotsAnEmptyRowGivesZero) {
  const Matrix gram = {{{2, 0, 0}, {0, 0, 0}, {0, 0, 4}}};
  Vector x{};
  ASSERT_TRUE((SolveSmall<Pivots::kNone>(gram, Vector{1, 5, 2}, 3, x)));
  EXPECT_EQ(x, (Vector{0.5, 0, 0.5}));
}

}  // namespace
}  // namespace trocar::math
