// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/hints.h"

#include <gtest/gtest.h>

namespace trocar::app {
namespace {

TEST(Hints, LeadThroughTheFirstMinute) {
  Situation now;
  EXPECT_EQ(HintText(now), "Loading the patient …");
  EXPECT_EQ(BadgeText(now), "");
  now.is_loaded = true;
  EXPECT_EQ(HintText(now), "Paused. Space starts.");
  now.is_paused = false;
  EXPECT_NE(HintText(now).find("Click into the picture"), std::string::npos);
  now.is_pointer_taken = true;
  EXPECT_EQ(HintText(now), "") << "who operates is not disturbed";
  EXPECT_EQ(BadgeText(now), "Right hand  ·  Esc gives the mouse back");
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

}  // namespace
}  // namespace trocar::app
