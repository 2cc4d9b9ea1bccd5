// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/clip_hold.h"

#include <gtest/gtest.h>

#include "trocar/math/random.h"

namespace trocar::surgery {
namespace {

constexpr double kMmHg = 133.322;
constexpr double kArterial = 12e3, kDuctal = 2.5e3;  // Pa

TEST(CalcClipHold, AGoodClipWithstands300MmHg) {
  const ClipHold hold = CalcClipHold({1.0, false, 0.001});
  EXPECT_NEAR(hold.pressure, 300 * kMmHg, 0.001 * hold.pressure);
  EXPECT_LE(CalcClipLoad(hold, 300 * kMmHg, 0.0), 1.0);
  EXPECT_EQ(CalcSlipSpeed(CalcClipLoad(hold, kArterial, 0.0)), 0.0);
  // pulled along the vessel it comes off between 4 and 5 N
  EXPECT_EQ(CalcSlipSpeed(CalcClipLoad(hold, 0.0, 4.0)), 0.0);
  EXPECT_GT(CalcSlipSpeed(CalcClipLoad(hold, 0.0, 5.0)), 0.0);
}

TEST(CalcClipHold, PressureAndPullAddUp) {
  const ClipHold hold = CalcClipHold({1.0, false, 0.001});
  EXPECT_LT(CalcClipLoad(hold, 0.5 * hold.pressure, 0.4 * hold.pull), 1.0);
  EXPECT_GT(CalcClipLoad(hold, 0.5 * hold.pressure, 0.6 * hold.pull), 1.0);
  EXPECT_EQ(CalcClipLoad(hold, -1e5, -10.0), 0.0) << "suction and pushing do not loosen it";
}

TEST(CalcClipHold, WhatIsPartialCrossedOrThickHoldsLess) {
  const ClipHold good = CalcClipHold({1.0, false, 0.0015});
  const auto slips = [](const ClipHold& hold, double pressure) {
    return CalcSlipSpeed(CalcClipLoad(hold, pressure, 0.0)) > 0.0;
  };
  EXPECT_FALSE(slips(CalcClipHold({0.9, false, 0.0015}), kArterial));
  EXPECT_TRUE(slips(CalcClipHold({0.8, false, 0.0015}), kArterial)) << "four fifths of an artery";
  EXPECT_FALSE(slips(CalcClipHold({0.8, false, 0.0015}), kDuctal));
  EXPECT_TRUE(slips(CalcClipHold({0.6, false, 0.0015}), kDuctal));
  EXPECT_TRUE(slips(CalcClipHold({1.0, true, 0.0015}), kArterial));
  EXPECT_LT(CalcClipHold({1.0, false, 0.005}).pull, 0.3 * good.pull) << "on a vessel of 10 mm";
  EXPECT_EQ(CalcClipHold({1.0, false, 0.0025}).pull, good.pull) << "up to 5 mm it does not matter";
}

TEST(CalcClipHold, NeverHoldsMoreWhenItIsWorse) {
  math::Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const ClipGrip grip{random.Uniform(), random.Uniform() < 0.5, random.Uniform(0.0005, 0.006)};
    ClipGrip worse = grip;
    worse.closure *= random.Uniform();
    worse.is_crossed = true;
    worse.vessel_radius *= 1.0 + random.Uniform();
    EXPECT_LE(CalcClipHold(worse).pressure, CalcClipHold(grip).pressure) << "seed 7, case " << i;
    const double p = random.Uniform(0, 2e4), f = random.Uniform(0, 5);
    EXPECT_GE(CalcClipLoad(CalcClipHold(worse), p, f), CalcClipLoad(CalcClipHold(grip), p, f));
    EXPECT_LE(CalcSlipSpeed(CalcClipLoad(CalcClipHold(worse), p, f)), 0.005);
  }
}

}  // namespace
}  // namespace trocar::surgery
