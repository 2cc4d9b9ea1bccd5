// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/hand_buttons.h"

#include <gtest/gtest.h>

#include <random>

namespace trocar::device {
namespace {

constexpr double kTick = 0.002;  // as a device's thread looks [s]

class HandButtonsTest : public testing::Test {
 protected:
  /// Holds the right hand's buttons so long, and looks every 2 ms.
  void Hold(std::uint32_t bits, double seconds, bool is_seen = true) {
    for (double t = 0; t < seconds - 1e-9; t += kTick) {
      now_ += kTick;
      buttons_.See(1, is_seen, bits, now_);
    }
  }
  bool IsHeld(HandAct act) const { return buttons_.Acts()[1].IsHeld(act); }
  std::uint32_t Presses(HandAct act) const { return buttons_.Acts()[1].CountPresses(act); }

  HandButtons buttons_;
  double now_ = 0;
};

TEST(HandAct, NamesComeBack) {
  for (std::size_t i = 0; i < kActCount; ++i) {
    const auto act = static_cast<HandAct>(i);
    EXPECT_EQ(FindAct(ActName(act)), act);
  }
  EXPECT_FALSE(FindAct("explode").has_value());
  EXPECT_FALSE(FindAct("").has_value());
}

TEST_F(HandButtonsTest, APedalIsHeldAfterTheDebounceAndUpAtOnce) {
  Hold(0, 0.02);
  Hold(1, HandButtons::kDebounce - kTick);
  EXPECT_FALSE(IsHeld(HandAct::kCut));
  Hold(1, 3 * kTick);
  EXPECT_TRUE(IsHeld(HandAct::kCut));
  EXPECT_EQ(Presses(HandAct::kCut), 1u);
  EXPECT_FALSE(IsHeld(HandAct::kCoagulate));
  EXPECT_FALSE(buttons_.Acts()[0].IsHeld(HandAct::kCut)) << "the other hand's";
  Hold(0, kTick);
  EXPECT_FALSE(IsHeld(HandAct::kCut));
}

// a switch that bounces for 10 ms at both ends: one press
TEST_F(HandButtonsTest, ABouncingSwitchIsPressedOnce) {
  std::mt19937 random(5);
  Hold(0, 0.02);
  for (int press = 1; press <= 200; ++press) {
    for (int i = 0; i < 5; ++i) Hold(random() % 2 == 0 ? 8u : 0u, kTick);
    Hold(8, 0.1);
    EXPECT_TRUE(IsHeld(HandAct::kNextTool));
    for (int i = 0; i < 5; ++i) Hold(random() % 2 == 0 ? 8u : 0u, kTick);
    Hold(0, 0.1);
    ASSERT_EQ(Presses(HandAct::kNextTool), static_cast<std::uint32_t>(press));
  }
}

TEST_F(HandButtonsTest, AGapInAPressMakesNoSecondPress) {
  Hold(0, 0.02);
  Hold(4, 0.1);
  Hold(0, 2 * kTick);
  EXPECT_FALSE(IsHeld(HandAct::kPreviousTool)) << "up is up at once";
  Hold(4, 0.1);
  EXPECT_TRUE(IsHeld(HandAct::kPreviousTool));
  EXPECT_EQ(Presses(HandAct::kPreviousTool), 1u);
  Hold(0, 0.05);
  Hold(4, 0.05);
  EXPECT_EQ(Presses(HandAct::kPreviousTool), 2u);
}

// a foot that stands on the pedal when the device comes back burns nothing
TEST_F(HandButtonsTest, WhatIsDownAtTheStartOrAfterALossDoesNothingUntilItWasUp) {
  Hold(3, 0.5);
  EXPECT_FALSE(IsHeld(HandAct::kCut) || IsHeld(HandAct::kCoagulate));
  Hold(0, 0.02);
  Hold(3, 0.05);
  EXPECT_TRUE(IsHeld(HandAct::kCut) && IsHeld(HandAct::kCoagulate));

  buttons_.ReleaseAll();
  EXPECT_FALSE(IsHeld(HandAct::kCut) || IsHeld(HandAct::kCoagulate));
  Hold(3, 0.5);
  EXPECT_FALSE(IsHeld(HandAct::kCut) || IsHeld(HandAct::kCoagulate));
  Hold(0, 0.02);
  Hold(1, 0.05);
  EXPECT_TRUE(IsHeld(HandAct::kCut));

  Hold(1, kTick, false);
  EXPECT_FALSE(IsHeld(HandAct::kCut)) << "out of sight";
  Hold(1, 0.5);
  EXPECT_FALSE(IsHeld(HandAct::kCut));
}

TEST_F(HandButtonsTest, ActsFollowTheMapAndTheRestIsIgnored) {
  ButtonMap map{};
  map[1][9] = HandAct::kRinse;
  map[1][15] = HandAct::kAspirate;
  buttons_ = HandButtons(map);
  Hold(0, 0.02);
  Hold(0xffffffff, 0.05);
  for (std::size_t i = 0; i < kActCount; ++i) {
    const auto act = static_cast<HandAct>(i);
    EXPECT_EQ(IsHeld(act), act == HandAct::kRinse || act == HandAct::kAspirate) << ActName(act);
  }
}

TEST_F(HandButtonsTest, SaysWhetherAnythingChanged) {
  std::array<HandSample, 3> samples;
  samples[0].is_valid = samples[1].is_valid = true;
  int changes = 0;
  for (int i = 0; i < 100; ++i) {
    samples[0].buttons = i >= 20 && i < 60 ? 1 : 0;
    changes += buttons_.See(samples, 0.002 * i) ? 1 : 0;
  }
  EXPECT_EQ(changes, 2) << "down and up";
  EXPECT_EQ(buttons_.Acts()[0].CountPresses(HandAct::kCut), 1u);
}

}  // namespace
}  // namespace trocar::device
