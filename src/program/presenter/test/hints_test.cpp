// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/hints.h"

#include <gtest/gtest.h>

namespace trocar::presenter {
namespace {

TEST(Hints, LeadThroughTheFirstMinute) {
  Situation now;
  EXPECT_EQ(HintText(now), "") << "at home";
  EXPECT_EQ(StateText(now), "");
  now.is_loading = true;
  EXPECT_EQ(HintText(now), "Loading …");
  EXPECT_EQ(BadgeText(now), "");
  now.is_loaded = true;
  EXPECT_EQ(HintText(now), "Paused. Space goes on.");
  now.is_paused = false;
  EXPECT_NE(HintText(now).find("Click into the picture"), std::string::npos);
  now.is_pointer_taken = true;
  EXPECT_EQ(HintText(now), "") << "who operates is not disturbed";
  EXPECT_EQ(BadgeText(now), "Right hand");
  now.is_laparoscope_held = true;
  EXPECT_EQ(BadgeText(now), "Laparoscope");
}

TEST(Hints, DemonstrationSaysHowToTakeOver) {
  Situation now{.is_loaded = true, .is_paused = false, .is_demonstration = true};
  EXPECT_NE(HintText(now).find("P takes over"), std::string::npos);
  EXPECT_EQ(StateText(now), "Demonstration");
  now.is_demonstration_over = true;
  EXPECT_NE(HintText(now).find("over"), std::string::npos);
  now.is_paused = true;
  EXPECT_EQ(StateText(now), "Paused");
}

TEST(Hints, BadgeNamesTheHandAndTheTrocarMode) {
  Situation now{.is_loaded = true, .is_paused = false, .is_right_hand = false, .is_fulcrum_mirrored = true};
  EXPECT_EQ(BadgeText(now), "Left hand  ·  real trocar");
}

TEST(Hints, BadgeSaysWhetherJawsAreOpenClosedOrHold) {
  Situation now{.is_loaded = true, .is_paused = false, .left_jaws = "holds ring 1", .right_jaws = "open"};
  EXPECT_EQ(BadgeText(now), "Left hand holds ring 1  ·  ▶ Right hand open");
  now.is_right_hand = false;
  now.is_slow = true;
  EXPECT_EQ(BadgeText(now), "▶ Left hand holds ring 1  ·  Right hand open  ·  slow motion");
}

// Every mode says in one line what mouse and keys do.
TEST(Hints, EveryModeFitsInALine) {
  int said = 0;
  KeyBindings left_handed, own;
  left_handed.SetLayout(KeyLayout::kLeftHanded);
  for (int bits = 0; bits < 512; ++bits) {
    Situation now;
    now.is_loaded = (bits & 1) != 0;
    now.is_paused = (bits & 2) != 0;
    now.is_demonstration = (bits & 4) != 0;
    now.is_laparoscope_held = (bits & 8) != 0;
    now.is_pointer_taken = (bits & 16) != 0;
    now.is_right_hand = (bits & 32) != 0;
    if ((bits & 64) != 0) now.bindings = &left_handed;
    now.has_tools = (bits & 128) != 0;
    if ((bits & 256) != 0) now.device = "Gamepad";
    const std::string text = ModeText(now);
    EXPECT_FALSE(text.empty());
    std::size_t characters = 0;
    for (const char c : text) characters += (c & 0xc0) != 0x80 ? 1 : 0;
    EXPECT_LE(characters, kLongestMode) << text;
    ++said;
  }
  EXPECT_EQ(said, 512);
  Situation now{.is_loaded = true, .is_paused = false, .is_pointer_taken = true};
  EXPECT_NE(ModeText(now).find("left button closes, right opens"), std::string::npos);
  now.bindings = &left_handed;
  EXPECT_NE(ModeText(now).find("right button closes, left opens"), std::string::npos);
  EXPECT_NE(ModeText(now).find("hold Comma: look"), std::string::npos) << ModeText(now);
  // what a person has set is said, too
  ASSERT_TRUE(own.SetKey("hold-laparoscope", 'm').ok());
  own.SetButton(ButtonAct::kCloseJaws, MouseButton::kMiddle);
  now.bindings = &own;
  EXPECT_NE(ModeText(now).find("hold M: look"), std::string::npos) << ModeText(now);
  EXPECT_NE(ModeText(now).find("middle button closes, right opens"), std::string::npos) << ModeText(now);
}

}  // namespace
}  // namespace trocar::presenter
