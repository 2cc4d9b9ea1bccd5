// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::math {
namespace {

TEST(CalcGradientNoise, RepeatsAfterItsPeriodAndIsContinuous) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{0.37 * i, 0.11 * i - 3, 0.23 * i};
    EXPECT_NEAR(CalcGradientNoise(p, 4), CalcGradientNoise(p + Vec3{4, -8, 12}, 4), 1e-9);
    EXPECT_NEAR(CalcGradientNoise(p, 0), CalcGradientNoise(p + Vec3{1e-7, 0, 0}, 0), 1e-5);
    EXPECT_LE(std::fabs(CalcGradientNoise(p, 0)), 1.2);
  }
  EXPECT_EQ(CalcGradientNoise({1, 2, 3}, 0), 0.0);
}

TEST(CalcCellNoise, NearestIsNeverBeyondSecondAndRepeats) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{0.37 * i, 0.11 * i - 3, 0.23 * i};
    const CellNoise a = CalcCellNoise(p, 8), b = CalcCellNoise(p + Vec3{8, 0, -8}, 8);
    EXPECT_LE(a.nearest, a.second);
    EXPECT_NEAR(a.nearest, b.nearest, 1e-9);
    EXPECT_NEAR(a.second, b.second, 1e-9);
  }
}

}  // namespace
}  // namespace trocar::math
