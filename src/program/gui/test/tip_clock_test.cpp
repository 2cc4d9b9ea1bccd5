// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/tip_clock.h"

#include <gtest/gtest.h>

namespace trocar::gui {
namespace {

TEST(TipClock, LetsATipBeReadAndEndsIt) {
  TipClock clock;
  EXPECT_TRUE(clock.Ask(10));
  EXPECT_TRUE(clock.Ask(10 + 0.9 * TipClock::kLongest));
  EXPECT_FALSE(clock.Ask(10 + 1.1 * TipClock::kLongest)) << "the pointer has not moved away";
  EXPECT_FALSE(clock.Ask(1000));
  clock.Leave();
  EXPECT_TRUE(clock.Ask(1001));
}

TEST(TipClock, EndsWhenThePersonWorks) {
  TipClock clock;
  EXPECT_TRUE(clock.Ask(0));
  clock.End();
  EXPECT_FALSE(clock.Ask(0.1));
  clock.Leave();
  EXPECT_TRUE(clock.Ask(0.2));
}

TEST(TipClock, KeepsTheFirstVisitAfterWorkElsewhere) {
  TipClock clock;
  clock.End();
  EXPECT_TRUE(clock.Ask(0));
}

}  // namespace
}  // namespace trocar::gui
