// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace trocar::training {
namespace {

/// The published example: exp(-5 t^2) for t = -1, -0.99, ..., 0.99.
std::vector<double> PublishedExample() {
  std::vector<double> speed;
  for (int i = 0; i < 200; ++i) {
    const double t = -1.0 + 0.01 * i;
    speed.push_back(std::exp(-5.0 * t * t));
  }
  return speed;
}

/// Speed of a minimum-jerk movement of length 1 m in 1 s: 30 t^2 - 60 t^3 + 30 t^4.
std::vector<double> MinimumJerkSpeed(int samples) {
  std::vector<double> speed;
  for (int i = 0; i <= samples; ++i) {
    const double t = double(i) / samples;
    speed.push_back(30.0 * t * t * (1.0 - t) * (1.0 - t));
  }
  return speed;
}

// Golden: the values printed in the docstring of the authors' code.
TEST(Smoothness, ReproducesThePublishedValues) {
  const std::vector<double> speed = PublishedExample();
  EXPECT_NEAR(*CalcSparc(speed, 100.0), -1.41403, 5e-6);
  EXPECT_NEAR(*CalcDimensionlessJerk(speed, 100.0), -335.74684, 5e-6);
  EXPECT_NEAR(*CalcLogDimensionlessJerk(speed, 100.0), -5.81636, 5e-6);
}

// Analytic: int v''^2 = 720 L^2 / T^5 and v_peak = 1.875 L / T, so the jerk is 204.8.
TEST(Smoothness, GivesMinimumJerkItsClosedForm) {
  const std::vector<double> speed = MinimumJerkSpeed(2000);
  EXPECT_NEAR(*CalcDimensionlessJerk(speed, 2000.0), -204.8, 1.0);
  EXPECT_NEAR(*CalcLogDimensionlessJerk(speed, 2000.0), -std::log(204.8), 5e-3);
  // in the range of healthy reaching
  EXPECT_NEAR(*CalcSparc(MinimumJerkSpeed(100), 100.0), -1.41, 0.03);
}

TEST(Smoothness, DependsOnNeitherAmplitudeNorDuration) {
  std::vector<double> speed = PublishedExample();
  const double sparc = *CalcSparc(speed, 100.0), jerk = *CalcDimensionlessJerk(speed, 100.0);
  for (double& v : speed) v *= 0.003;
  EXPECT_NEAR(*CalcSparc(speed, 100.0), sparc, 1e-9);
  EXPECT_NEAR(*CalcDimensionlessJerk(speed, 100.0), jerk, 1e-6);
  EXPECT_NEAR(*CalcDimensionlessJerk(speed, 50.0), jerk, 1e-6) << "twice as slow";
}

TEST(Smoothness, RanksAHaltingMovementBelowASmoothOne) {
  std::vector<double> halting = PublishedExample();
  for (std::size_t i = 0; i < halting.size(); ++i) halting[i] *= 1.0 + 0.6 * std::sin(0.3 * double(i));
  EXPECT_LT(*CalcSparc(halting, 100.0), *CalcSparc(PublishedExample(), 100.0) - 0.2);
  EXPECT_LT(*CalcLogDimensionlessJerk(halting, 100.0),
            *CalcLogDimensionlessJerk(PublishedExample(), 100.0) - 1.0);
}

TEST(Smoothness, IsUndefinedWithoutMotion) {
  const std::vector<double> still(100, 0.0), empty, two{1.0, 2.0}, constant(100, 0.25);
  EXPECT_FALSE(CalcSparc(still, 100.0));
  EXPECT_FALSE(CalcSparc(empty, 100.0));
  EXPECT_FALSE(CalcDimensionlessJerk(still, 100.0));
  EXPECT_FALSE(CalcDimensionlessJerk(two, 100.0));
  EXPECT_FALSE(CalcLogDimensionlessJerk(constant, 100.0)) << "no jerk at all has no logarithm";
  const std::vector<double> bad{1.0, std::nan(""), 2.0, 1.0},
      infinite{1.0, std::numeric_limits<double>::infinity(), 1.0};
  EXPECT_FALSE(CalcSparc(bad, 100.0));
  EXPECT_FALSE(CalcDimensionlessJerk(bad, 100.0));
  EXPECT_FALSE(CalcDimensionlessJerk(infinite, 100.0));
}

}  // namespace
}  // namespace trocar::training
