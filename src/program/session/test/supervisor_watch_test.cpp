// SPDX-License-Identifier: Apache-2.0
#include "supervisor_watch.h"

#include <gtest/gtest.h>

namespace trocar::session {
namespace {

TEST(SupervisorWatch, WritesZeroAfterTenMillisecondsAndEveryFour) {
  constexpr std::int64_t kMs = 1'000'000;
  SupervisorWatch watch;
  EXPECT_FALSE(watch.Look(0, 0));
  EXPECT_FALSE(watch.Look(0, 1'000 * kMs)) << "watching begins with the first beat";
  EXPECT_EQ(watch.CalcSleep(1'000 * kMs), 2 * kMs);
  EXPECT_FALSE(watch.Look(7, 1'000 * kMs));
  EXPECT_EQ(watch.CalcSleep(1'000 * kMs), 2 * kMs) << "a round";
  EXPECT_EQ(watch.CalcSleep(1'009 * kMs), kMs) << "until it is due";
  EXPECT_EQ(watch.CalcSleep(1'010 * kMs), kMs / 10) << "a nap";
  EXPECT_FALSE(watch.Look(7, 1'010 * kMs - 1));
  EXPECT_EQ(watch.CountTrips(), 0u);
  EXPECT_TRUE(watch.Look(7, 1'010 * kMs));
  EXPECT_EQ(watch.CountTrips(), 1u);
  EXPECT_FALSE(watch.Look(7, 1'014 * kMs - 1));
  EXPECT_TRUE(watch.Look(7, 1'014 * kMs));
  EXPECT_TRUE(watch.Look(7, 1'018 * kMs));
  EXPECT_EQ(watch.CountTrips(), 1u) << "it has stopped once";
  EXPECT_EQ(watch.CalcSleep(1'021 * kMs), kMs);
  EXPECT_FALSE(watch.Look(8, 1'030 * kMs)) << "it beats again";
  EXPECT_FALSE(watch.Look(8, 1'040 * kMs - 1));
  EXPECT_TRUE(watch.Look(8, 1'040 * kMs));
  EXPECT_EQ(watch.CountTrips(), 2u);
}

}  // namespace
}  // namespace trocar::session
