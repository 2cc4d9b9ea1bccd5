// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/hand_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {

using math::Vec3;

namespace {

const Vec3 kPort{-0.09, 0.045, -0.015}, kTip{-0.029, 0.107, -0.147};

/// Where a point that the tool holds comes to when it rolls.
Vec3 Roll(const Vec3& held, double roll) {
  const math::Pose before = instrument::CalcToolPose(kPort, instrument::FindJoints(kPort, kTip, 0.3, 0)),
                   after =
                       instrument::CalcToolPose(kPort, instrument::FindJoints(kPort, kTip, 0.3 + roll, 0));
  return after * (math::Inverse(before) * held);
}

TEST(FindRoll, TurnsWhatIsHeldAboutTheShaftEitherWay) {
  const Vec3 shaft = math::Normalized(kTip - kPort), held = kTip + Vec3{0.004, -0.002, 0.003};
  for (const Vec3& axis : {shaft, -1.0 * shaft}) {
    for (const double angle : {0.5, -0.5}) {
      const Vec3 turned = kTip + math::Rotate(math::RotationAbout(axis, angle), held - kTip);
      EXPECT_LT(math::Distance(Roll(held, FindRoll(kPort, kTip, axis, angle)), turned), 1e-12);
    }
  }
}

TEST(FindRoll, IsLessTheLessTheAxisLiesAlongTheShaftAndNothingAcrossIt) {
  const Vec3 shaft = math::Normalized(kPort - kTip);
  const Vec3 across = math::Normalized(math::Cross(shaft, {0, 0, 1}));
  EXPECT_NEAR(FindRoll(kPort, kTip, across, 1.0), 0, 1e-12);
  EXPECT_NEAR(FindRoll(kPort, kTip, math::Normalized(shaft + across), 1.0), std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace trocar::agent
