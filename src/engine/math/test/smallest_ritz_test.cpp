// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/smallest_ritz.h"

#include <gtest/gtest.h>

#include <vector>

namespace trocar::math {
namespace {

TEST(SmallestRitz, SinksToTheSmallestEigenvalue) {
  const std::vector<double> eigenvalues = {0.013, 0.2, 0.31, 0.5, 0.62, 0.7, 0.81, 0.9, 1.0, 1.1};
  std::vector<double> r(eigenvalues.size(), 1.0), p = r;
  SmallestRitz ritz;
  EXPECT_EQ(ritz.Value(), INFINITY);
  double beta = 0, last = INFINITY;
  for (std::size_t step = 0; step < eigenvalues.size(); ++step) {
    double rr = 0, pq = 0, next = 0;
    for (std::size_t i = 0; i < r.size(); ++i) rr += r[i] * r[i], pq += p[i] * eigenvalues[i] * p[i];
    const double alpha = rr / pq;
    ritz.Add(alpha, beta);
    EXPECT_LE(ritz.Value(), last);
    EXPECT_GE(ritz.Value(), 0.97 * eigenvalues[0]);
    last = ritz.Value();
    for (std::size_t i = 0; i < r.size(); ++i) r[i] -= alpha * eigenvalues[i] * p[i], next += r[i] * r[i];
    beta = next / rr;
    for (std::size_t i = 0; i < r.size(); ++i) p[i] = r[i] + beta * p[i];
  }
  EXPECT_NEAR(ritz.Value(), eigenvalues[0], 0.03 * eigenvalues[0]);
}

}  // namespace
}  // namespace trocar::math
