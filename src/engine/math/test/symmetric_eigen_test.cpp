// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "trocar/math/random.h"

namespace trocar::math {
namespace {

template <std::size_t kCount>
double Dot(const SmallVector<kCount>& a, const SmallVector<kCount>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) sum += a[i] * b[i];
  return sum;
}

/// Checks A v = lambda v, that the vectors are an orthonormal basis, and the order.
template <std::size_t kCount>
void ExpectEigen(const SmallMatrix<kCount>& a, double scale) {
  const SymmetricEigen<kCount> found = CalcSymmetricEigen(a);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t row = 0; row < kCount; ++row) {
      EXPECT_NEAR(Dot<kCount>(a[row], found.vectors[i]), found.values[i] * found.vectors[i][row],
                  1e-14 * scale);
    }
    for (std::size_t j = 0; j <= i; ++j)
      EXPECT_NEAR(Dot<kCount>(found.vectors[i], found.vectors[j]), i == j ? 1.0 : 0.0, 1e-14);
    EXPECT_LE(found.values[i - (i > 0 ? 1 : 0)], found.values[i]);
  }
}

TEST(SymmetricEigen, OfRandomMatrices) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed 7, trial " << trial);
    const double scale = std::pow(10.0, trial % 13 - 6);
    SmallMatrix<5> a{};
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = i; j < 5; ++j) a[i][j] = a[j][i] = scale * random.Uniform(-1, 1);
    }
    ExpectEigen(a, 10 * scale);
  }
}

// u = (1, 2, 2) / 3: 9 u u^T has the eigenvalues 0, 0, 9
TEST(SymmetricEigen, OfOneDirection) {
  const SmallMatrix<3> a = {{{1, 2, 2}, {2, 4, 4}, {2, 4, 4}}};
  ExpectEigen(a, 9);
  const SymmetricEigen<3> found = CalcSymmetricEigen(a);
  EXPECT_NEAR(found.values[0], 0, 1e-14);
  EXPECT_NEAR(found.values[1], 0, 1e-14);
  EXPECT_NEAR(found.values[2], 9, 1e-14);
  EXPECT_NEAR(std::fabs(found.vectors[2][0]), 1.0 / 3, 1e-15);
  EXPECT_NEAR(std::fabs(found.vectors[2][1]), 2.0 / 3, 1e-15);
}

TEST(SymmetricEigen, OfADiagonalAndOfNothing) {
  const SymmetricEigen<3> found = CalcSymmetricEigen(SmallMatrix<3>{{{3, 0, 0}, {0, -1, 0}, {0, 0, 2}}});
  EXPECT_EQ(found.values, (SmallVector<3>{-1, 2, 3}));
  EXPECT_EQ(found.vectors[0], (SmallVector<3>{0, 1, 0}));
  EXPECT_EQ(CalcSymmetricEigen(SmallMatrix<3>{}).values, SmallVector<3>{});
}

// a small coupling beside entries of very different size is turned away, not left as rounding
TEST(SymmetricEigen, OfTwoScales) {
  const SmallMatrix<2> a = {{{1e6, 1e-3}, {1e-3, 1e-6}}};
  const SymmetricEigen<2> found = CalcSymmetricEigen(a);
  EXPECT_NEAR(found.values[0], 1e-6 - 1e-12, 1e-15);
  EXPECT_NEAR(found.values[1], 1e6, 1e-9);
}

}  // namespace
}  // namespace trocar::math
