// SPDX-License-Identifier: Apache-2.0
#include "own_motion.h"

#include <LinearMath/btTransformUtil.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace trocar::rigid {
namespace {

constexpr double kPi = std::numbers::pi;

class OwnMotionTest : public testing::Test {
 protected:
  double Draw(double most) { return most * (2.0 * static_cast<double>(random_()) / 4294967295.0 - 1.0); }
  btVector3 DrawVector(double most) {
    const double x = Draw(most), y = Draw(most), z = Draw(most);
    return {x, y, z};
  }
  btQuaternion DrawRotation() {
    const btVector3 axis = DrawVector(1.0);
    return btQuaternion(axis.isZero() ? btVector3(1, 0, 0) : axis, Draw(kPi));
  }

  std::mt19937 random_{7};
};

double Difference(const btTransform& a, const btTransform& b) {
  double most = (a.getOrigin() - b.getOrigin()).length();
  for (int i = 0; i < 3; ++i) most = std::max(most, (a.getBasis()[i] - b.getBasis()[i]).length());
  return most;
}

TEST_F(OwnMotionTest, MovesAsBulletDoes) {
  constexpr double kStep = 1.0 / 480;
  int beyond = 0;
  for (int i = 0; i < 10000; ++i) {
    const double fast = std::pow(10.0, Draw(4.0));
    const btTransform X(DrawRotation(), DrawVector(10.0));
    const btVector3 velocity = DrawVector(50.0), turn = DrawVector(fast);
    const btTransform moved = Move(X, velocity, turn, kStep);
    if (turn.length() * kStep > kPi / 4) {
      // Bullet's rotation there is of another angle with each speed
      ++beyond;
      ASSERT_NEAR(TurnBetween(X.getRotation(), moved.getRotation()).length(), kPi / 4, 1e-9);
      continue;
    }
    btTransform wanted;
    btTransformUtil::integrateTransform(X, velocity, turn, kStep, wanted);
    ASSERT_LT(Difference(moved, wanted), 1e-10) << "turn of " << turn.length();
  }
  EXPECT_GT(beyond, 500);
  EXPECT_LT(beyond, 5000);
}

TEST_F(OwnMotionTest, TurnsAboutAnAxis) {
  const btTransform X = btTransform::getIdentity();
  const btTransform moved = Move(X, {3, 0, 0}, {0, 0, kPi}, 0.125);
  EXPECT_NEAR(moved.getOrigin().x(), 0.375, 1e-15);
  const btVector3 x = moved.getBasis().getColumn(0);
  EXPECT_NEAR(x.x(), std::cos(kPi / 8), 1e-15);
  EXPECT_NEAR(x.y(), std::sin(kPi / 8), 1e-15);
  EXPECT_NEAR(x.z(), 0.0, 1e-15);
}

TEST_F(OwnMotionTest, FindsTheTurnThatWasMade) {
  for (const double angle : {0.0, 1e-12, 1e-7, 9.9e-5, 1.01e-4, 0.1, 1.0, 2.5, 3.1}) {
    for (int i = 0; i < 100; ++i) {
      const btQuaternion from = DrawRotation();
      btVector3 axis = DrawVector(1.0);
      axis.normalize();
      // a quaternion and its negative are one orientation
      const btQuaternion to = btQuaternion(axis, angle) * from * (i % 2 == 0 ? 1.0 : -1.0);
      EXPECT_LT((TurnBetween(from, to) - axis * angle).length(), 1e-14 + 1e-13 * angle) << angle;
    }
  }
}

TEST_F(OwnMotionTest, APartOfATurnIsASlerp) {
  for (int i = 0; i < 1000; ++i) {
    const btQuaternion from = DrawRotation(), to = DrawRotation();
    const double share = 0.5 + Draw(0.5);
    const btQuaternion wanted = from.slerp(to, share), found = TurnPart(from, to, share);
    EXPECT_NEAR(std::abs(wanted.dot(found)), 1.0, 1e-12);
    EXPECT_LT(TurnBetween(wanted, found).length(), 1e-7);
  }
}

}  // namespace
}  // namespace trocar::rigid
