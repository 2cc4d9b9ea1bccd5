// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/small_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

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

std::vector<SmallVector<4>> DrawRows(std::size_t count, Random& random) {
  std::vector<SmallVector<4>> rows(count);
  for (SmallVector<4>& row : rows) {
    for (double& entry : row) entry = random.Uniform(-1, 1);
    row[2] *= 1e-4;
  }
  return rows;
}

// oracle: Eigen's decomposition
TEST(SolveLeastSquares, FindsWhatEigenFinds) {
  Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    auto rows = DrawRows(4 + trial, random);
    std::vector<double> b(rows.size());
    for (double& entry : b) entry = random.Uniform(-1, 1);
    Eigen::MatrixXd a(rows.size(), 4);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) a(i, k) = rows[i][k];
    }
    const Eigen::VectorXd expected =
        a.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(b.data(), a.rows()));
    const auto x = SolveLeastSquares<4>(rows, b);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(x[k], expected[k], 1e-9 * (1 + std::fabs(expected[k]))) << "seed 6, trial " << trial;
  }
}

TEST(SolveLeastSquares, LeavesOutWhatTheRowsDoNotDetermine) {
  Random random(7);
  auto rows = DrawRows(20, random);
  std::vector<double> b;
  for (SmallVector<4>& row : rows) {
    row[1] = 3 * row[0], row[3] = 0;
    b.push_back(6 * row[0] - 2 * row[2]);
  }
  const auto x = SolveLeastSquares<4>(rows, b);
  EXPECT_EQ(x[0], 0) << "the longer of the two columns stays";
  EXPECT_NEAR(x[1], 2, 1e-12);
  EXPECT_NEAR(x[2], -2, 1e-9);
  EXPECT_EQ(x[3], 0);
  std::vector<SmallVector<4>> nothing(5);
  EXPECT_EQ(SolveLeastSquares<4>(nothing, std::span(b).first(5)), SmallVector<4>{});
}

}  // namespace
}  // namespace trocar::math
