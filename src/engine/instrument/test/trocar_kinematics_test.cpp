// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/trocar_kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "trocar/math/random.h"

namespace trocar::instrument {

using math::Pose;
using math::Vec3;

namespace {

constexpr double kDegree = M_PI / 180;

TEST(CalcToolPose, AtRestPointsStraightDownIntoTheAbdomen) {
  const Pose pose = CalcToolPose({0.01, 0.02, 0.03}, {0, 0, 0, 0.1, 0});
  EXPECT_NEAR(math::Distance(pose.translation, {0.01, 0.02, -0.07}), 0.0, 1e-15);
}

TEST(CalcToolPose, ShaftPassesThroughThePortWhateverTheJoints) {
  math::Random random(5);
  const Vec3 port{0.02, -0.05, 0.01};
  for (int trial = 0; trial < 100; ++trial) {
    const TrocarJoints joints{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-3, 3),
                              random.Uniform(0.03, 0.28), 0};
    const Pose pose = CalcToolPose(port, joints);
    EXPECT_NEAR(math::Distance(pose * Vec3{0, 0, joints.depth}, port), 0.0, 1e-15);
  }
}

// The fulcrum inverts: pan to the positive side moves the tip to the patient's right.
TEST(CalcToolPose, FulcrumMovesTheTipAgainstTheHandle) {
  const Pose pose = CalcToolPose({0, 0, 0}, {10 * kDegree, 0, 0, 0.1, 0});
  EXPECT_NEAR(pose.translation.x, -0.1 * std::sin(10 * kDegree), 1e-15);
  EXPECT_GT((pose * Vec3{0, 0, 0.3}).x, 0.0);
}

TEST(FindJoints, InvertsTheForwardMap) {
  math::Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const TrocarJoints joints{random.Uniform(-1.2, 1.2), random.Uniform(-1.2, 1.2), 0.3,
                              random.Uniform(0.03, 0.28), 0.2};
    const TrocarJoints found = FindJoints({0, 0, 0}, CalcToolPose({0, 0, 0}, joints).translation, 0.3, 0.2);
    EXPECT_NEAR(found.pan, joints.pan, 1e-12);
    EXPECT_NEAR(found.tilt, joints.tilt, 1e-12);
    EXPECT_NEAR(found.depth, joints.depth, 1e-12);
  }
}

TEST(ClampJoints, KeepsLimitsAndSwallowsNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TrocarJoints clamped = ClampJoints({9, nan, nan, nan, -1}, {});
  EXPECT_EQ(clamped.pan, JointLimits{}.max_pan);
  EXPECT_EQ(clamped.tilt, -JointLimits{}.max_tilt);
  EXPECT_EQ(clamped.spin, 0.0);
  EXPECT_EQ(clamped.depth, JointLimits{}.min_depth);
  EXPECT_EQ(clamped.jaw, 0.0);
}

TEST(LimitSpeed, NeverLetsTheTipJump) {
  const TrocarJoints from{0, 0, 0, 0.1, 0}, to{1, -1, 5, 0.2, 1};
  const TrocarJoints next = LimitSpeed(from, to, 2.0, 10.0, 0.001);
  const double moved = math::Distance(CalcToolPose({}, from).translation, CalcToolPose({}, next).translation);
  EXPECT_LE(moved, 2.0 * 0.001 * std::sqrt(3.0) + 1e-12);
  EXPECT_GT(moved, 0.001);
  EXPECT_EQ(LimitSpeed(from, from, 2.0, 10.0, 0.001), from);
}

}  // namespace
}  // namespace trocar::instrument
