// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/clocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>

namespace trocar::record {
namespace {

constexpr double kNow = 1.8e9;  // in 2027 [s]

TEST(ClockWatch, NoticesWhatFaultR10Lists) {
  struct Case {
    const char* name;
    double jump;  // [s]
  };
  for (const Case& one :
       {Case{"an hour back", -3600}, Case{"a day forward", 86400}, Case{"a leap second", -1}}) {
    ClockWatch watch({100, kNow});
    EXPECT_FALSE(watch.See({100.05, kNow + 0.05})) << one.name;
    const auto jump = watch.See({100.1, kNow + 0.1 + one.jump});
    ASSERT_TRUE(jump.has_value()) << one.name;
    EXPECT_NEAR(*jump, one.jump, 1e-6) << one.name;
    EXPECT_FALSE(watch.See({100.15, kNow + 0.15 + one.jump})) << "a jump is told once";
  }
}

TEST(ClockWatch, SlewingAndAStalledThreadAreNoJumps) {
  ClockWatch watch({0, kNow});
  double steady = 0, wall = kNow;
  for (int i = 0; i < 20000; ++i) {
    steady += 0.05, wall += 0.05 * (1 + 500e-6);  // the fastest that adjtime slews
    ASSERT_FALSE(watch.See({steady, wall})) << i;
  }
  EXPECT_GT(wall - kNow - steady, 0.49) << "over all it is as much as a jump";
  EXPECT_FALSE(watch.See({steady + 30, wall + 30})) << "the thread waited for half a minute";
}

TEST(ClockWatch, ReadsTheComputersClocks) {
  const ClockReading first = ReadClocks();
  EXPECT_NEAR(first.wall, static_cast<double>(std::time(nullptr)), 2);
  ClockWatch watch(first);
  for (int i = 0; i < 1000; ++i) ASSERT_FALSE(watch.See(ReadClocks())) << i;
}

TEST(WallClock, HasItsOffsetInSummerInWinterAndAfter2038) {
  const char* zone = std::getenv("TZ");
  const std::string before = zone != nullptr ? zone : "";
  ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
  ::tzset();
  EXPECT_EQ(FormatWallClock(1792889999.9), "2026-10-25T02:59:59+02:00");
  EXPECT_EQ(FormatWallClock(1792890000.0), "2026-10-25T02:00:00+01:00") << "the hour that comes twice";
  EXPECT_EQ(FormatWallClock(2147483648.0), "2038-01-19T04:14:08+01:00");
  zone != nullptr ? ::setenv("TZ", before.c_str(), 1) : ::unsetenv("TZ");
  ::tzset();
}

}  // namespace
}  // namespace trocar::record
