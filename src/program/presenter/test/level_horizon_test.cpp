// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/level_horizon.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::presenter {
namespace {

using math::Vec3;

math::Pose LookAlong(double pan, double tilt) {
  return instrument::CalcToolPose({0, -0.1, 0}, {.pan = pan, .tilt = tilt, .depth = 0.05});
}

// A straight scope in a trocar that is panned while it looks forward rolls its picture; the assistant turns it back.
TEST(LevelHorizon, KeepsUprightThingsUpright) {
  for (const double pan : {-0.9, -0.3, 0.0, 0.4, 1.0}) {
    const math::Pose X = LookAlong(pan, 0.8), level = LevelHorizon(X);
    EXPECT_NEAR(math::Rotate(level.rotation, Vec3{1, 0, 0}).z, 0.0, 1e-9) << pan;
    EXPECT_GT(math::Rotate(level.rotation, Vec3{0, 1, 0}).z, 0.0) << pan;
    const Vec3 view{0, 0, -1};
    EXPECT_LT(math::Distance(math::Rotate(level.rotation, view), math::Rotate(X.rotation, view)), 1e-9);
    EXPECT_EQ(level.translation, X.translation);
  }
  EXPECT_GT(std::fabs(math::Rotate(LookAlong(0.4, 0.8).rotation, Vec3{1, 0, 0}).z), 0.3) << "it has rolled";
}

TEST(LevelHorizon, LooksDownWithTheHeadAtTheTop) {
  const math::Pose level = LevelHorizon(LookAlong(0, 0));
  EXPECT_GT(math::Rotate(level.rotation, Vec3{0, 1, 0}).y, 0.99);
}

// No jump on the way from straight down to straight ahead.
TEST(LevelHorizon, TurnsEvenly) {
  math::Pose before = LevelHorizon(LookAlong(0.3, 0.0));
  for (double tilt = 0.01; tilt < 1.3; tilt += 0.01) {
    const math::Pose now = LevelHorizon(LookAlong(0.3, tilt));
    const Vec3 side{1, 0, 0};
    EXPECT_LT(math::Distance(math::Rotate(now.rotation, side), math::Rotate(before.rotation, side)), 0.06)
        << tilt;
    before = now;
  }
}

}  // namespace
}  // namespace trocar::presenter
