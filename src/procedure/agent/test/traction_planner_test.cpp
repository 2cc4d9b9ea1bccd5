// SPDX-License-Identifier: Apache-2.0
// The hand that holds: it draws on, gives way and swings by what it feels.
#include "traction_planner.h"

#include <gtest/gtest.h>

#include "planner_hands.h"

namespace trocar::agent {

using math::Vec3;

namespace {

const Vec3 kPort{0, 0, 0.15}, kHold{0, 0, 0};

Traction PlanUpwards(HandMotion& hand, bool is_flap_held = false) {
  TractionGoal goal;
  goal.most = 0.030;
  goal.way = {0, 0, 1};
  goal.is_flap_held = is_flap_held;
  goal.fibres = 100;
  goal.axis = {0, 1, 0};
  goal.aside = {1, 0, 0};
  Traction traction = PlanTraction(goal);
  traction.p_hold = hand.Tip();
  return traction;
}

/// Lets the hand draw for a while under a pull that does not change.
void Draw(Traction& traction, HandMotion& hand, double pull, double parted, double seconds) {
  for (double time = 0; time < seconds; time += kTestTick) {
    TakeUpSlack(traction, hand, {true, {0, 0, -pull}}, parted, time);
    (void)hand.Step(kTestTick);
  }
}

TEST(PlanTraction, DrawsTheWayAskedForFirstAndThenToTheSides) {
  HandMotion hand = HandAt(kPort, kHold);
  const Traction traction = PlanUpwards(hand);
  ASSERT_EQ(traction.ways.size(), 4u);
  EXPECT_LT(math::Distance(traction.ways[0], {0, 0, 1}), 1e-12);
  EXPECT_GT(traction.ways[1].x, 0.3);
  EXPECT_LT(traction.ways[2].x, -0.3);
  EXPECT_EQ(traction.swings_left, 4);
  // a flap that is free goes to the side first, or it would stay before the hook
  EXPECT_GT(PlanUpwards(hand, true).ways[0].x, 0.7);
  EXPECT_TRUE(PlanTraction({}).ways.empty()) << "nothing is asked of it";
}

TEST(TakeUpSlack, DrawsOnWithTheFibresAsFarAsTheyHaveParted) {
  HandMotion hand = HandAt(kPort, kHold);
  Traction traction = PlanUpwards(hand);
  Draw(traction, hand, 1.0, 0.5, 10.0);
  EXPECT_NEAR(hand.Tip().z, 0.015, 0.0015) << "half of them, half of the way";
  Draw(traction, hand, 1.0, 1.0, 20.0);
  EXPECT_NEAR(hand.Tip().z, 0.030, 0.0015);
}

TEST(TakeUpSlack, GivesWayToAStrongPullAndRestsBetween) {
  HandMotion hand = HandAt(kPort, kHold);
  Traction traction = PlanUpwards(hand);
  Draw(traction, hand, 1.0, 0.5, 10.0);
  const double drawn = hand.Tip().z;
  Draw(traction, hand, 8.0, 0.5, 5.0);
  EXPECT_NEAR(hand.Tip().z, drawn, 1e-9) << "taut";
  Draw(traction, hand, 14.0, 0.5, 5.0);
  EXPECT_LT(hand.Tip().z, drawn - 0.005);
}

TEST(TakeUpSlack, DoesNothingWithoutAHold) {
  HandMotion hand = HandAt(kPort, kHold);
  Traction traction = PlanUpwards(hand);
  EXPECT_FALSE(TakeUpSlack(traction, hand, {false, {}}, 1.0, 100.0));
  EXPECT_FALSE(hand.IsMoving());
}

TEST(Swing, GoesToTheNextSideAndEndsWhereItPulls) {
  for (const double pull : {1.0, 20.0}) {
    HandMotion hand = HandAt(kPort, kHold);
    Traction traction = PlanUpwards(hand);
    BeginSwing(traction, hand, 60);
    EXPECT_EQ(traction.swings_left, 3);
    EXPECT_EQ(traction.fibres_before, 60u);
    ASSERT_TRUE(traction.is_swinging);
    for (int tick = 0; tick < 1000 && traction.is_swinging; ++tick) {
      (void)hand.Step(kTestTick);
      GoOnSwinging(traction, hand, {true, {0, 0, -pull}});
    }
    EXPECT_FALSE(traction.is_swinging);
    const double aside = hand.Tip().x;
    EXPECT_EQ(aside > 0.004, pull < 10) << aside;
  }
}

}  // namespace
}  // namespace trocar::agent
