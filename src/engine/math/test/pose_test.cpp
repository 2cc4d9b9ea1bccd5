// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::math {
namespace {

TEST(Rotate, QuarterTurnAboutZTakesXToY) {
  const Vec3 turned = Rotate(RotationAbout({0, 0, 1}, M_PI / 2), {1, 0, 0});
  EXPECT_NEAR(Distance(turned, {0, 1, 0}), 0.0, 1e-15);
}

TEST(Pose, ComposesLikeItsMapsAndInvertsItself) {
  Random random(1);
  const auto vector = [&] {
    return Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Pose a{RotationAbout(Normalized(vector()), random.Uniform(-3, 3)), vector()};
    const Pose b{RotationAbout(Normalized(vector()), random.Uniform(-3, 3)), vector()};
    const Vec3 p = vector();
    EXPECT_NEAR(Distance((a * b) * p, a * (b * p)), 0.0, 1e-14);
    EXPECT_NEAR(Distance(Inverse(a) * (a * p), p), 0.0, 1e-14);
  }
}

TEST(RotationBetween, TakesAnyDirectionToAnyOther) {
  Random random(2);
  const auto unit = [&] {
    return Normalized(Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 from = unit(), to = trial == 0 ? -from : unit();
    EXPECT_NEAR(Distance(Rotate(RotationBetween(from, to), from), to), 0.0, 1e-12);
  }
}

TEST(RotationFromAxes, ReproducesTheAxesForEveryBranch) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 axis = Normalized(Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
    const Quaternion q = RotationAbout(axis, random.Uniform(-M_PI, M_PI));
    const Quaternion back =
        RotationFromAxes(Rotate(q, {1, 0, 0}), Rotate(q, {0, 1, 0}), Rotate(q, {0, 0, 1}));
    EXPECT_NEAR(std::abs(q.w * back.w + q.x * back.x + q.y * back.y + q.z * back.z), 1.0, 1e-12);
  }
}

TEST(RotationAngle, IsThatOfTheShortestWay) {
  const Quaternion askew = RotationAbout(Normalized(Vec3{1, -2, 0.5}), 2.0);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Quaternion turned = askew * RotationAbout(axis, 0.3);
    EXPECT_NEAR(AngleBetween(askew, turned), 0.3, 1e-12);
    EXPECT_NEAR(AngleBetween(askew, {-turned.w, -turned.x, -turned.y, -turned.z}), 0.3, 1e-12);
  }
  EXPECT_EQ(AngleBetween({1, 0, 0, 0}, {1 + 1e-15, 0, 0, 0}), 0.0) << "a rounded unit quaternion";
  EXPECT_EQ(SquaredNorm(Quaternion{1, -2, 3, -4}), 30.0);
}

TEST(RotationAngle, OfDirectionsDoesNotHangOnTheirLength) {
  EXPECT_NEAR(AngleBetween(Vec3{2, 0, 0}, Vec3{0, 0, 0.001}), 0.5 * M_PI, 1e-12);
  EXPECT_EQ(AngleBetween(Vec3{1, 1, 1}, Vec3{0.1, 0.1, 0.1}), 0.0);
  EXPECT_NEAR(AngleBetween(Vec3{1, 2, 3}, Vec3{-2, -4, -6}), M_PI, 1e-7);
}

}  // namespace
}  // namespace trocar::math
