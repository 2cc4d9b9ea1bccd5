// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/device_hands.h"

#include <gtest/gtest.h>

namespace trocar::session {

using instrument::Hand;
using instrument::kLeft;
using instrument::kRight;
using scene::HandControls;

namespace {

using device::HandAct;
using instrument::TrocarJoints;

scene::Scene MakeScene() {
  scene::Scene scene;
  scene.instruments[kLeft].tray.resize(3);
  scene.instruments[kRight].tray.resize(5);
  return scene;
}

class DeviceHandsTest : public testing::Test {
 protected:
  DeviceHandsTest() {
    Put(kLeft, {0.1, 0.2, 0.3, 0.15, 0.5});
    Put(kRight, {-0.1, 0.1, 0, 0.12, 0.4});
  }
  void Put(Hand hand, const TrocarJoints& joints, bool is_seen = true) {
    samples_[hand] = {joints.pan, joints.tilt, joints.spin, joints.depth, joints.jaw, 0, is_seen};
  }
  void Hold(Hand hand, HandAct act, bool is_held = true) {
    acts_[hand].is_held[static_cast<std::size_t>(act)] = is_held;
  }
  void Press(Hand hand, HandAct act) { ++acts_[hand].presses[static_cast<std::size_t>(act)]; }
  const TrocarJoints& Move(Hand hand) {
    hands_.Step(acts_, input_);
    hands_.Move(samples_, acts_, input_);
    return input_.hands[hand];
  }

  DeviceHands hands_{MakeScene()};
  DeviceSamples samples_;
  DeviceActs acts_;
  scene::Input input_;
};

TEST_F(DeviceHandsTest, PedalsAreTheirHandsAndNobodyElsesAreLifted) {
  input_.controls[kRight].coagulate = true;  // by a key
  Hold(kLeft, HandAct::kCut);
  Hold(kLeft, HandAct::kAspirate);
  PressPedals(acts_, input_);
  EXPECT_EQ(input_.controls[kLeft], (HandControls{0, true, false, false, true}));
  EXPECT_EQ(input_.controls[kRight], (HandControls{0, false, true, false, false}));
}

TEST_F(DeviceHandsTest, EveryPressOfAToolButtonCountsOnce) {
  Press(kLeft, HandAct::kNextTool);
  Press(kRight, HandAct::kPreviousTool);
  hands_.Step(acts_, input_);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.controls[kLeft].tool, 1);
  EXPECT_EQ(input_.controls[kRight].tool, 4) << "round the tray";
  for (int i = 0; i < 7; ++i) Press(kLeft, HandAct::kNextTool);  // between two looks
  Press(kLeft, HandAct::kPreviousTool);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.controls[kLeft].tool, (1 + 7 - 1) % 3);
  Press(kLeft, HandAct::kNextTool);
  hands_.Ignore(acts_);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.controls[kLeft].tool, (1 + 7 - 1) % 3) << "while nothing runs, buttons do nothing";
}

TEST_F(DeviceHandsTest, AnotherDeviceCountsFromZeroAgain) {
  for (int i = 0; i < 4; ++i) Press(kRight, HandAct::kNextTool);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.controls[kRight].tool, 4);
  acts_ = {};
  Press(kRight, HandAct::kNextTool);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.controls[kRight].tool, 0);
}

TEST_F(DeviceHandsTest, TheAssistantGoesRound) {
  Press(kLeft, HandAct::kAssistant);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.assistant, scene::AssistantCommand::kRetract);
  for (int i = 0; i < 3; ++i) Press(kRight, HandAct::kAssistant);
  hands_.Step(acts_, input_);
  EXPECT_EQ(input_.assistant, scene::AssistantCommand::kWait);
}

TEST_F(DeviceHandsTest, AClutchedToolStandsAndGoesOnFromThere) {
  const TrocarJoints start = Move(kLeft);
  EXPECT_EQ(start, (TrocarJoints{0.1, 0.2, 0.3, 0.15, 0.5}));
  Hold(kLeft, HandAct::kClutch);
  Put(kLeft, {0.4, -0.2, 1.0, 0.10, 0.0});
  EXPECT_EQ(Move(kLeft), start) << "jaws included, which may hold tissue";
  EXPECT_EQ(Move(kRight).pan, -0.1) << "the other hand goes on";
  Hold(kLeft, HandAct::kClutch, false);
  const TrocarJoints after = Move(kLeft);
  EXPECT_NEAR(after.pan, start.pan, 1e-15);
  EXPECT_NEAR(after.depth, start.depth, 1e-15);
  EXPECT_EQ(after.jaw, 0.0) << "the fingers are where they are";
  Put(kLeft, {0.45, -0.2, 1.0, 0.12, 0.0});
  EXPECT_NEAR(Move(kLeft).pan, start.pan + 0.05, 1e-15);
  EXPECT_NEAR(Move(kLeft).depth, start.depth + 0.02, 1e-15);
  hands_.Restart();
  EXPECT_EQ(Move(kLeft).pan, 0.45) << "the first tick again: the tool is where the hand is";
}

TEST_F(DeviceHandsTest, FreezeHoldsFromOnePressToTheNextAndEndsWithTheDevice) {
  const TrocarJoints start = Move(kRight);
  Press(kRight, HandAct::kFreeze);
  Put(kRight, {0.3, 0.3, 0, 0.2, 0.1});
  EXPECT_EQ(Move(kRight), start);
  EXPECT_EQ(Move(kRight), start);
  EXPECT_TRUE(hands_.IsFrozen(kRight));
  Put(kRight, {0.3, 0.3, 0, 0.2, 0.1}, false);
  EXPECT_EQ(Move(kRight), start) << "out of sight";
  EXPECT_FALSE(hands_.IsFrozen(kRight));
  Put(kRight, {0.3, 0.3, 0, 0.2, 0.1});
  EXPECT_EQ(Move(kRight).pan, 0.3);
  Press(kRight, HandAct::kFreeze);
  Put(kRight, {0.5, 0.3, 0, 0.2, 0.1});
  EXPECT_EQ(Move(kRight).pan, 0.3);
  Press(kRight, HandAct::kFreeze);
  EXPECT_NEAR(Move(kRight).pan, 0.3, 1e-15);
}

TEST_F(DeviceHandsTest, AKeyClutchesADevicesHand) {
  const TrocarJoints start = Move(kRight);
  hands_.SetClutch(kRight, true);
  Put(kRight, {0.3, 0.3, 0, 0.2, 0.1});
  EXPECT_EQ(Move(kRight), start);
  hands_.SetClutch(kRight, false);
  EXPECT_NEAR(Move(kRight).tilt, start.tilt, 1e-15);
}

}  // namespace
}  // namespace trocar::session
