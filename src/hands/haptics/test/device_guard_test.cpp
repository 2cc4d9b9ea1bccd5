// SPDX-License-Identifier: Apache-2.0
// What of a device's reports is believed, number by number: each limit from both sides.
#include "trocar/haptics/device_guard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace trocar::haptics {
namespace {

constexpr double kTick = 0.001;  // [s]

math::Quaternion TurnAboutZ(double angle) {
  return {std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle)};
}

/// A guard that has believed `warm_up` reports of a device that stands still.
class Guarded {
 public:
  explicit Guarded(int warm_up = 50, const DeviceGuardSettings& settings = {}) : guard(settings) {
    sample.status = device::ForceDeviceStatus::kOk;
    sample.is_calibrated = true;
    sample.buttons = 5;
    sample.jaw = 0.25;
    sample.temperature = 0.5;
    for (int i = 0; i < warm_up; ++i) Report();
  }
  /// A new report after `ticks` of time.
  const GuardedDevice& Report(double ticks = 1) {
    ++sample.sequence;
    return Wait(ticks);
  }
  /// The same report again.
  const GuardedDevice& Wait(double ticks = 1) {
    now += ticks * kTick;
    return device = guard.Step(sample, now);
  }
  const GuardedDevice& ReportAt(const math::Vec3& position, double ticks = 1) {
    sample.position = position;
    return Report(ticks);
  }
  const GuardedDevice& ReportTurned(const math::Quaternion& q, double ticks = 1) {
    sample.orientation = q;
    return Report(ticks);
  }
  DeviceGuard guard;
  device::ForceSample sample;
  GuardedDevice device;
  double now = 7.0;
};

TEST(DeviceGuard, BelievesAGoodReportAsItIs) {
  Guarded g(0);
  g.sample.position = {0.01, -0.02, 0.03};
  g.sample.orientation = {2 * 0.5, 0, 0, 0};
  g.sample.status = device::ForceDeviceStatus::kWarm;
  g.Report();
  EXPECT_TRUE(g.device.has_pose);
  EXPECT_EQ(g.device.fault, Fault::kNone);
  EXPECT_EQ(g.device.position, (math::Vec3{0.01, -0.02, 0.03}));
  EXPECT_EQ(g.device.buttons, 5u);
  EXPECT_EQ(g.device.jaw, 0.25);
  EXPECT_EQ(g.device.temperature, 0.5);
  EXPECT_TRUE(g.device.is_warm);
  EXPECT_TRUE(g.device.is_calibrated);
  EXPECT_EQ(g.device.scale, 1.0);
  EXPECT_EQ(g.device.velocity, math::Vec3{}) << "one report shows no motion";
  EXPECT_EQ(g.guard.GetCounts().good, 1u);
  g.sample.status = device::ForceDeviceStatus::kOk;
  g.sample.is_calibrated = false;
  g.Report();
  EXPECT_FALSE(g.device.is_warm);
  EXPECT_FALSE(g.device.is_calibrated);
}

TEST(DeviceGuard, KnowsNothingOfADeviceThatHasNotReported) {
  const GuardedDevice device;
  EXPECT_FALSE(device.has_pose || device.is_warm || device.is_calibrated);
  EXPECT_EQ(device.buttons, 0u);
  EXPECT_EQ(device.jaw, 0.0);
  EXPECT_EQ(device.temperature, 0.0);
  EXPECT_EQ(device.scale, 0.0);
  EXPECT_EQ(device.fault, Fault::kDeviceLost);
  const DeviceGuardCounts counts;
  EXPECT_EQ(counts.good + counts.bad + counts.jumps + counts.silences, 0u);
  Guarded g(0);
  g.Wait(30);
  EXPECT_EQ(g.device.fault, Fault::kSilent);
  EXPECT_EQ(g.guard.GetCounts().silences, 1u);
}

// what lies on a limit is within it
TEST(DeviceGuard, TheLimitsThemselvesAreGood) {
  // numbers whose sums and differences are exact
  DeviceGuardSettings settings;
  settings.stale_age = 0.5;
  settings.silent_age = 1.0;
  Guarded g(0, settings);
  const auto report = [&](double now, double x) {
    ++g.sample.sequence;
    g.sample.position.x = x;
    return g.device = g.guard.Step(g.sample, now);
  };
  report(8.0, 0.0);
  report(8.25, 0.25);
  ASSERT_GT(g.device.velocity.x, 0.0);
  EXPECT_GT(g.guard.Step(g.sample, 8.75).velocity.x, 0.0) << "at the age from which silence counts";
  EXPECT_EQ(g.guard.GetCounts().silences, 0u);
  EXPECT_EQ(g.guard.Step(g.sample, 8.7500001).velocity.x, 0.0);
  EXPECT_EQ(g.guard.Step(g.sample, 9.2499999).fault, Fault::kNone);
  EXPECT_EQ(g.guard.Step(g.sample, 9.25).fault, Fault::kSilent) << "at which the force is zero";
  Guarded fast(0);
  fast.now = 8.0;
  fast.Report(0);
  fast.sample.position.z = 2.0 * 0.25 + 0.0005;
  ++fast.sample.sequence;
  fast.guard.Step(fast.sample, 8.25);
  EXPECT_EQ(fast.guard.GetCounts().jumps, 0u) << "2 m/s and the encoders' step";
}

TEST(DeviceGuard, ReachEndsAtAMetre) {
  for (const double reach : {0.999, 1.0, 1.001, 5.0, 30.0}) {
    Guarded g(0);
    g.ReportAt({0, reach, 0});
    EXPECT_EQ(g.guard.GetCounts().bad, reach > 1.0 ? 1u : 0u) << reach;
    EXPECT_EQ(g.device.has_pose, reach <= 1.0) << reach;
  }
}

TEST(DeviceGuard, RotationsHaveUnitLength) {
  const auto is_bad = [](const math::Quaternion& q) {
    Guarded g;
    g.ReportTurned(q);
    return g.guard.GetCounts().bad == 1;
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_bad({1, 0, 0, 0}));
  EXPECT_FALSE(is_bad({-1, 0, 0, 0}));
  EXPECT_FALSE(is_bad({1.04, 0, 0, 0}));
  EXPECT_FALSE(is_bad({0.96, 0, 0, 0}));
  EXPECT_TRUE(is_bad({1.06, 0, 0, 0}));
  EXPECT_TRUE(is_bad({0.94, 0, 0, 0}));
  EXPECT_TRUE(is_bad({0, 0, 0, 0})) << "what a driver says that has no rotation";
  EXPECT_TRUE(is_bad({nan, 0, 0, 0}));
  EXPECT_TRUE(is_bad({1, inf, 0, 0}));
  EXPECT_TRUE(is_bad({1, 0.5, 0, 0}));
  EXPECT_TRUE(is_bad({1, 0, 0.5, 0}));
  EXPECT_TRUE(is_bad({1, 0, 0, 0.5}));
}

TEST(DeviceGuard, PositionsAreFinite) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      Guarded g;
      g.sample.position[axis] = bad;
      g.Report();
      EXPECT_EQ(g.guard.GetCounts().bad, 1u);
      EXPECT_EQ(g.device.position, math::Vec3{}) << "the last good one is held";
      EXPECT_EQ(g.device.fault, Fault::kNone);
    }
  }
}

TEST(DeviceGuard, TwoBadReportsAreBridgedAndTheThirdIsAFault) {
  Guarded g;
  const auto spoil = [&](bool is_bad) {
    g.sample.position.y = is_bad ? std::nan("") : 0.0;
    return g.Report().fault;
  };
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(spoil(true), Fault::kNone);
    EXPECT_EQ(spoil(true), Fault::kNone);
    for (int i = 0; i < 30; ++i) ASSERT_EQ(spoil(false), Fault::kNone) << i;
  }
  EXPECT_EQ(spoil(true), Fault::kNone);
  EXPECT_EQ(spoil(true), Fault::kNone);
  EXPECT_EQ(spoil(true), Fault::kBadSamples);
  EXPECT_EQ(g.guard.GetCounts().bad, 9u);
}

// The promise for a device that goes to and fro between what is believed and what is not: the third bad report or jump among
// 32 is the fault, whatever lies between them; with every other report that is the fifth report.
TEST(DeviceGuard, ReportsThatAlternateAreAFaultAtTheThirdThatIsRefused) {
  for (const bool are_jumps : {false, true}) {
    for (const double size : {0.003, 0.05, 0.5}) {
      for (int period = 2; period <= 15; ++period) {
        Guarded g;
        int reports = 0;
        for (; reports < 200 && g.device.fault == Fault::kNone; ++reports) {
          const bool is_refused = reports % period == 0;
          g.ReportAt({0, !is_refused ? 0.0 : are_jumps ? size : std::nan(""), 0});
          EXPECT_EQ(g.device.position, math::Vec3{}) << "no pose of a jump";
        }
        EXPECT_EQ(g.device.fault, are_jumps ? Fault::kJump : Fault::kBadSamples) << period;
        EXPECT_EQ(reports, 2 * period + 1) << period;
        EXPECT_EQ(g.guard.GetCounts().bad + g.guard.GetCounts().jumps, 3u);
      }
    }
  }
  // bad ones and jumps in turn: the last names the fault
  Guarded both;
  both.ReportAt({0, 0.05, 0}), both.ReportAt({}), both.ReportAt({0, std::nan(""), 0}), both.ReportAt({});
  EXPECT_EQ(both.device.fault, Fault::kNone);
  EXPECT_EQ(both.ReportAt({0, 0.05, 0}).fault, Fault::kJump);
  // one in sixteen never is
  Guarded g;
  for (int i = 0; i < 500; ++i) {
    g.ReportAt({0, i % 16 == 0 ? 0.05 : 0.0, 0});
    ASSERT_EQ(g.device.fault, Fault::kNone) << i;
  }
}

TEST(DeviceGuard, TheFaultStaysUntilTheRefusedOnesAreOutOfTheWindow) {
  Guarded g;
  const auto spoil = [&] {
    for (int i = 0; g.device.fault == Fault::kNone && i < 10; ++i)
      g.ReportAt({0, i % 2 == 0 ? std::nan("") : 0.0, 0});
    EXPECT_EQ(g.device.fault, Fault::kBadSamples);
  };
  spoil();
  int good = 0;
  while (good < 100 && g.ReportAt({}).fault == Fault::kBadSamples) ++good;
  EXPECT_EQ(good, 27) << "32 reports after the first of the three";
  // and a device that was lost begins anew
  spoil();
  g.sample.status = device::ForceDeviceStatus::kLost;
  EXPECT_EQ(g.Wait().fault, Fault::kDeviceLost);
  g.sample.status = device::ForceDeviceStatus::kOk;
  EXPECT_EQ(g.ReportAt({}).fault, Fault::kNone);
  EXPECT_EQ(g.ReportAt({0, std::nan(""), 0}).fault, Fault::kNone);
  EXPECT_EQ(g.ReportAt({0, std::nan(""), 0}).fault, Fault::kNone);
}

TEST(DeviceGuard, SpeedIsLimitedToTwoMetresASecond) {
  // 2 m/s for a tick, and half a millimetre of slack for encoders
  for (const double step : {0.00249, 0.00251}) {
    Guarded g;
    g.ReportAt({0, 0, step});
    EXPECT_EQ(g.guard.GetCounts().jumps, step > 0.0025 ? 1u : 0u) << step;
    EXPECT_EQ(g.device.position.z, step > 0.0025 ? 0.0 : step);
  }
  // over four ticks four times as far
  for (const double step : {0.0084, 0.0086}) {
    Guarded g;
    g.ReportAt({0, step, 0}, 4);
    EXPECT_EQ(g.guard.GetCounts().jumps, step > 0.0085 ? 1u : 0u) << step;
  }
  // reports of one moment are judged as if half a millisecond apart
  for (const double step : {0.00149, 0.00151}) {
    Guarded g;
    g.ReportAt({step, 0, 0}, 0.01);
    EXPECT_EQ(g.guard.GetCounts().jumps, step > 0.0015 ? 1u : 0u) << step;
  }
}

TEST(DeviceGuard, TurningIsLimitedToThirtyRadiansASecond) {
  for (const double turn : {0.0495, 0.0505, 1.0}) {
    for (const double sign : {1.0, -1.0}) {
      Guarded g;
      math::Quaternion q = TurnAboutZ(turn);
      q = {sign * q.w, sign * q.x, sign * q.y, sign * q.z};  // the same orientation
      g.ReportTurned(q);
      EXPECT_EQ(g.guard.GetCounts().jumps, turn > 0.05 ? 1u : 0u) << turn;
    }
  }
  for (const math::Quaternion& q : {math::Quaternion{0.8, 0.6, 0, 0}, math::Quaternion{0.8, 0, 0.6, 0}}) {
    Guarded g;
    g.ReportTurned(q);
    EXPECT_EQ(g.guard.GetCounts().jumps, 1u) << "about any axis";
  }
  // and from wherever the stylus points
  for (const double turn : {0.0495, 0.0505}) {
    Guarded g(0);
    const math::Quaternion askew{0.5, 0.5, -0.5, 0.5};
    g.ReportTurned(askew);
    for (int i = 0; i < 20; ++i) g.Report();
    g.ReportTurned(askew * TurnAboutZ(turn));
    EXPECT_EQ(g.guard.GetCounts().jumps, turn > 0.05 ? 1u : 0u) << turn;
  }
}

TEST(DeviceGuard, AStylusThatStandsAskewDoesNotTurn) {
  Guarded g(0);
  g.sample.orientation = {0.5, 0.5, -0.5, 0.5};
  for (int i = 0; i < 20; ++i) g.Report();
  EXPECT_EQ(g.guard.GetCounts().jumps, 0u);
  EXPECT_EQ(g.guard.GetCounts().good, 20u);
}

TEST(DeviceGuard, AJumpHasNoVelocity) {
  Guarded g;
  for (int tick = 1; tick <= 20; ++tick) g.ReportAt({0.0005 * tick, 0, 0});
  ASSERT_GT(g.device.velocity.x, 0.4);
  for (int i = 0; i < 3; ++i) g.ReportAt({0, 0, 0.1});
  EXPECT_EQ(g.device.fault, Fault::kJump);
  EXPECT_EQ(g.device.velocity, math::Vec3{}) << "not even that of the way before it";
}

TEST(DeviceGuard, TheThirdJumpInARowIsWhereTheDeviceIs) {
  Guarded g;
  EXPECT_EQ(g.ReportAt({0, 0, 0.1}).fault, Fault::kNone);
  EXPECT_EQ(g.Report().fault, Fault::kNone);
  EXPECT_EQ(g.device.position, math::Vec3{});
  EXPECT_EQ(g.Report().fault, Fault::kJump);
  EXPECT_EQ(g.device.position, (math::Vec3{0, 0, 0.1}));
  EXPECT_EQ(g.device.velocity, math::Vec3{}) << "what it came through is not known";
  EXPECT_EQ(g.guard.GetCounts().jumps, 3u);
  EXPECT_EQ(g.Report().fault, Fault::kJump) << "as long as the three are among the last 32";
  EXPECT_EQ(g.guard.GetCounts().jumps, 3u) << "it is there now";
  // two and back: the count in a row begins anew
  Guarded back;
  for (int i = 0; i < 4; ++i) {
    back.ReportAt({0, 0, 0.1}), back.Report();
    ASSERT_EQ(back.device.fault, Fault::kNone);
    for (int k = 0; k < 30; ++k) back.ReportAt({});
    ASSERT_EQ(back.device.fault, Fault::kNone);
  }
  EXPECT_EQ(back.guard.GetCounts().jumps, 8u);
}

TEST(DeviceGuard, VelocityFollowsWithinThreeMilliseconds) {
  Guarded g;
  double x = 0;
  for (int tick = 1; tick <= 30; ++tick) {
    g.ReportAt({x += 0.0005, 0, 0});
    // first order: each tick takes 1 / (1 + 3) of what is missing
    EXPECT_NEAR(g.device.velocity.x, 0.5 * (1.0 - std::pow(0.75, tick)), 1e-9) << tick;
  }
}

TEST(DeviceGuard, SilenceIsBridgedForTenMillisecondsAndOverAfterEighteen) {
  Guarded g;
  g.ReportAt({0.0005, 0, 0});
  EXPECT_NE(g.device.velocity.x, 0.0);
  for (int tick = 1; tick <= 17; ++tick) {
    g.Wait();
    EXPECT_EQ(g.device.fault, Fault::kNone) << tick;
    EXPECT_NEAR(g.device.scale, tick <= 10 ? 1.0 : (18.0 - tick) / 8.0, 1e-6) << tick;
    EXPECT_EQ(g.device.buttons, 5u);
    if (tick != 10) {
      EXPECT_EQ(g.device.velocity == math::Vec3{}, tick > 10) << tick;
    }
  }
  EXPECT_EQ(g.guard.GetCounts().silences, 1u);
  g.Wait(1.01);
  EXPECT_EQ(g.device.fault, Fault::kSilent);
  EXPECT_EQ(g.device.scale, 0.0);
  EXPECT_EQ(g.device.buttons, 0u) << "a silent device holds no safety switch";
  EXPECT_TRUE(g.device.has_pose) << "it is held where it was";
  g.Report();
  EXPECT_EQ(g.device.fault, Fault::kNone);
  EXPECT_EQ(g.device.scale, 1.0);
  EXPECT_EQ(g.device.buttons, 5u);
  EXPECT_EQ(g.guard.GetCounts().silences, 1u);
  g.Wait(12);
  EXPECT_EQ(g.guard.GetCounts().silences, 2u);
}

TEST(DeviceGuard, BadReportsAreNoSignOfLife) {
  Guarded g;
  g.sample.position.x = 2.0;
  for (int i = 0; i < 19; ++i) g.Report();
  EXPECT_NE(g.device.fault, Fault::kNone);
  EXPECT_EQ(g.device.scale, 0.0);
  EXPECT_EQ(g.device.buttons, 0u);
}

TEST(DeviceGuard, ALostDeviceIsForgotten) {
  Guarded g;
  g.ReportAt({0, 0, 0.002});
  g.sample.status = device::ForceDeviceStatus::kLost;
  g.Report();
  EXPECT_EQ(g.device.fault, Fault::kDeviceLost);
  EXPECT_FALSE(g.device.has_pose);
  EXPECT_EQ(g.device.buttons, 0u);
  EXPECT_EQ(g.device.scale, 0.0);
  // back, far away: no jump, and what was reported before it was seen counts
  g.sample.status = device::ForceDeviceStatus::kOk;
  g.sample.position = {0.3, 0, 0};
  g.Wait();
  EXPECT_EQ(g.device.fault, Fault::kNone);
  EXPECT_EQ(g.device.position.x, 0.3);
  EXPECT_EQ(g.device.velocity, math::Vec3{});
  EXPECT_EQ(g.guard.GetCounts().jumps, 0u);
}

TEST(DeviceGuard, ADeviceThatComesBackBeginsAnew) {
  Guarded g;
  g.sample.status = device::ForceDeviceStatus::kLost;
  for (int i = 0; i < 100; ++i) g.Wait();
  // its last report is taken although it is not new, and its silence counts from here
  g.sample.status = device::ForceDeviceStatus::kOk;
  EXPECT_EQ(g.Wait().fault, Fault::kNone);
  EXPECT_TRUE(g.device.has_pose);
  EXPECT_EQ(g.device.scale, 1.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(g.Wait().fault, Fault::kNone);
  for (int i = 0; i < 10; ++i) g.Wait();
  EXPECT_EQ(g.device.fault, Fault::kSilent);
  // and so do its bad reports
  Guarded bad;
  bad.sample.position.x = std::nan("");
  bad.Report(), bad.Report();
  bad.sample.status = device::ForceDeviceStatus::kLost;
  bad.Wait();
  bad.sample.status = device::ForceDeviceStatus::kOk;
  for (int i = 0; i < 2; ++i) EXPECT_NE(bad.Report().fault, Fault::kBadSamples);
  EXPECT_EQ(bad.Report().fault, Fault::kBadSamples) << "the third since it came back";
}

TEST(LoopGuard, CountsSoftensAndStops) {
  EXPECT_EQ(LoopTiming{}.stiffness_scale, 1.0);
  EXPECT_EQ(LoopTiming{}.fault, Fault::kNone);
  EXPECT_FALSE(LoopTiming{}.is_late);
  LoopGuard guard;
  LoopTiming timing = guard.Step(0.0004);
  EXPECT_FALSE(timing.is_late);
  EXPECT_FALSE(guard.Step(0.0005).is_late) << "half a period";
  timing = guard.Step(0.0006);
  EXPECT_TRUE(timing.is_late);
  EXPECT_EQ(timing.stiffness_scale, 1.0);
  timing = guard.Step(0.005);
  EXPECT_EQ(timing.stiffness_scale, 1.0);
  EXPECT_EQ(timing.fault, Fault::kNone);
  timing = guard.Step(0.0051);
  EXPECT_EQ(timing.stiffness_scale, 0.5);
  EXPECT_EQ(timing.fault, Fault::kNone);
  // back within half a second, evenly
  for (int tick = 1; tick <= 600; ++tick) {
    timing = guard.Step(0.0);
    ASSERT_NEAR(timing.stiffness_scale, std::fmin(1.0, 0.5 + 0.001 * tick), 1e-9) << tick;
  }
  EXPECT_EQ(guard.Step(0.020).fault, Fault::kNone);
  EXPECT_EQ(guard.Step(0.0201).fault, Fault::kOverrun);
  EXPECT_EQ(guard.Step(0.0).fault, Fault::kNone);
  EXPECT_EQ(guard.Step(std::nan("")).fault, Fault::kOverrun) << "a lateness that is no number is no promise";
}

}  // namespace
}  // namespace trocar::haptics
