// SPDX-License-Identifier: Apache-2.0
// How tools stand before vessels and hooks under fibres, against the kinematics of a trocar.
#include "tool_alignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "planner_hands.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

const Vec3 kPort{0.03, 0.02, 0.15}, kPoint{0.004, -0.006, 0.001};

Pose ToolAt(const Vec3& tip, double spin) {
  return instrument::CalcToolPose(kPort, instrument::FindJoints(kPort, tip, spin, 0.0));
}

TEST(PointBeyond, LiesOnTheShaftsLineOnEitherSideOfThePoint) {
  for (const double way : {0.012, -0.020}) {
    const Vec3 p = PointBeyond(kPort, kPoint, way);
    EXPECT_NEAR(math::Distance(p, kPort) - math::Distance(kPoint, kPort), way, 1e-15);
    EXPECT_NEAR(math::Norm(math::Cross(p - kPort, kPoint - kPort)), 0.0, 1e-15);
  }
}

TEST(LineUpAcross, StandsOffWithTheJawsAcrossTheVessel) {
  const Vec3 along = math::Normalized(Vec3{0.3, 1.0, -0.2});
  const HandGoal goal = LineUpAcross(kPort, kPoint, along, 0.012, 0.5);
  ASSERT_TRUE(goal.tip && goal.spin && goal.jaw);
  EXPECT_NEAR(math::Distance(*goal.tip, kPoint), 0.012, 1e-12);
  EXPECT_LT(math::Distance(*goal.tip, kPort), math::Distance(kPoint, kPort));
  EXPECT_EQ(*goal.jaw, 0.5);
  // the jaws open along +y of the tool
  const Vec3 opening = math::Rotate(ToolAt(*goal.tip, *goal.spin).rotation, {0, 1, 0});
  EXPECT_NEAR(math::Dot(opening, along), 0.0, 1e-6);
}

TEST(BeginMotion, MovesOnlyWhatTheGoalNames) {
  HandMotion hand = HandAt(kPort, kPoint);
  BeginMotion(hand, {});
  EXPECT_FALSE(hand.IsMoving());
  EXPECT_FALSE(hand.IsTurning());
  HandGoal jaw;
  jaw.jaw = 0.4;
  BeginMotion(hand, jaw);
  EXPECT_FALSE(hand.IsMoving());
  EXPECT_TRUE(hand.IsTurning());
  HandGoal tip;
  tip.tip = kPoint + Vec3{0.01, 0, 0};
  BeginMotion(hand, tip);
  while (hand.IsMoving() || hand.IsTurning()) (void)hand.Step(kTestTick);
  EXPECT_LT(math::Distance(hand.Tip(), *tip.tip), 1e-12);
  EXPECT_EQ(hand.Jaw(), 0.4);
}

TEST(FindUpperSpin, PointsTheToolsUpperSideAlongNotAgainst) {
  for (const Vec3& across : {Vec3{0, 0, -1}, Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}}) {
    const Vec3 upper = math::Rotate(ToolAt(kPoint, FindUpperSpin(kPort, kPoint, across)).rotation, {0, 1, 0});
    EXPECT_GT(math::Dot(upper, across), 0.0);
  }
}

TEST(HookTip, BringsTheMiddleOfTheToeToThePoint) {
  const Vec3 toe = HookToe(kPort, kPoint, 0.7);
  const Pose X = ToolAt(HookTip(kPoint, toe), 0.7);
  const Vec3 middle = X * (0.5 * (instrument::kHookToe.a + instrument::kHookToe.b));
  // the toe turns a little as the tip moves
  EXPECT_LT(math::Distance(middle, kPoint), 2e-4);
  EXPECT_GT(math::Distance(HookTip(kPoint, toe), kPoint), 1e-3);
}

}  // namespace
}  // namespace trocar::agent
