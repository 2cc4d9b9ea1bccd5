// SPDX-License-Identifier: Apache-2.0
// Acts over a made-up patient: what they set going, and when they are done.
#include "act_execution.h"

#include <gtest/gtest.h>

#include "made_up_patient.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;

namespace {

using Kind = SurgeonAct::Kind;

struct Execution : public testing::Test, protected MadeUpPatient {
  double seconds = 0;

  /// The last act that was added to the plan.
  SurgeonAct& Act() { return plan.acts.back(); }
  void Begin() { BeginAct(Act(), View(), memory); }
  bool Step() {
    const SurgeonAct act = Act();
    ActList next(scene.instruments);
    const bool is_done = StepAct(act, View(), memory, seconds, next);
    for (HandMotion& hand : memory.hands) (void)hand.Step(kTestTick);
    seconds += kTestTick;
    plan.acts.insert(plan.acts.begin(), next.acts.begin(), next.acts.end());
    return is_done;
  }
  /// \return seconds until it is done, at most 20
  double Finish() {
    for (int tick = 0; tick < 20 * 120; ++tick)
      if (Step()) return seconds;
    return 20;
  }
};

TEST_F(Execution, AReachEndsAtThePlace) {
  plan.Reach(kRight, Place::AtNode(4));
  Begin();
  EXPECT_FALSE(Step());
  EXPECT_LT(Finish(), 5.0);
  EXPECT_LT(math::Distance(memory.Hand(kRight).Tip(), known.rest[4]), 1e-9);
}

TEST_F(Execution, ADrawStopsWhereThePullIsFelt) {
  plan.Add(Kind::kDraw, "draw", 5.0).hand = kLeft;
  Act().by = {0, 0, 0.030};
  Begin();
  const Vec3 from = memory.Hand(kLeft).Tip();
  for (int tick = 0; tick < 30; ++tick) ASSERT_FALSE(Step());
  seen.instruments[kLeft].force = {0, 0, -13};
  EXPECT_TRUE(Step());
  for (int tick = 0; tick < 240; ++tick) (void)memory.Hand(kLeft).Step(kTestTick);
  const double drawn = math::Distance(memory.Hand(kLeft).Tip(), from);
  EXPECT_GT(drawn, 0.0);
  EXPECT_LT(drawn, 0.015);
}

TEST_F(Execution, EasingGivesWayToThePullUntilHardlyAnyIsFelt) {
  plan.Ease(kLeft);
  Begin();
  const Vec3 from = memory.Hand(kLeft).Tip();
  seen.instruments[kLeft].force = {4, 0, 0};
  for (int tick = 0; tick < 120; ++tick) ASSERT_FALSE(Step());
  EXPECT_GT(memory.Hand(kLeft).Tip().x, from.x + 0.002);
  seen.instruments[kLeft].force = {0.5, 0, 0};
  EXPECT_TRUE(Step());
}

TEST_F(Execution, AFootIsLiftedAfterItsTime) {
  plan.Add(Kind::kBurn, "burn", 2.0).seconds = 0.5;
  Begin();
  EXPECT_TRUE(memory.controls[kRight].coagulate);
  EXPECT_NEAR(Finish(), 0.5, 0.02);
  EXPECT_FALSE(memory.controls[kRight].coagulate);
}

TEST_F(Execution, ExchangesAndTheAssistantAreWaitedFor) {
  plan.Add(Kind::kExchange, "exchange", 6.0).tool = 3;
  Begin();
  EXPECT_EQ(memory.controls[kRight].tool, 3);
  EXPECT_FALSE(Step());
  seen.operation.tools[kRight] = 3;
  EXPECT_TRUE(Step());
  plan.Assist(scene::AssistantCommand::kRetract);
  Begin();
  EXPECT_EQ(memory.assistant, scene::AssistantCommand::kRetract);
  EXPECT_FALSE(Step());
  seen.operation.assistant.is_holding = true;
  EXPECT_TRUE(Step());
}

TEST_F(Execution, AHoldThatSlipsIsTakenAnewBeforeTheHookGoesOn) {
  const SurgeonView view = View();
  Planning on{view, memory, plan};
  AddDissection(on, {"the bed", known.BedStrands(1.0), known.BedOrder(known.BedStrands(1.0))});
  memory.dissection.backing_off = 10;  // the hook rests
  Begin();
  seen.instruments[kLeft].is_grasping = true;
  for (int tick = 0; tick < 120; ++tick) ASSERT_FALSE(Step());
  seen.instruments[kLeft].is_grasping = false;
  EXPECT_NEAR(Finish() - 1.0, 0.5, 0.03);
  EXPECT_EQ(memory.dissection.holds_left, 3);
  EXPECT_EQ(plan.acts[0].kind, Kind::kChooseHold);
  EXPECT_EQ(plan.acts[1].kind, Kind::kDissect);
}

}  // namespace
}  // namespace trocar::agent
