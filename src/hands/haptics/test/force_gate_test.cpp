// SPDX-License-Identifier: Apache-2.0
// The gate, number by number: each limit from both sides.
#include "trocar/haptics/force_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "haptic_rig.h"

namespace trocar::haptics {
namespace {

constexpr double kMax = 3.3, kContinuous = 0.88;  // [N]

GateInput Good() {
  GateInput input;
  input.temperature = std::nan("");
  input.conditions = {true, true, true, true, true};
  return input;
}
GateSettings Settings() {
  device::ForceLimits limits;
  limits.max_force = kMax;
  limits.max_continuous_force = kContinuous;
  return MakeGateSettings(limits, 0.001);
}

class Gated {
 public:
  explicit Gated(const GateSettings& settings = Settings()) : gate(settings) {}
  const GateOutput& Step(const math::Vec3& force = {}) {
    input.force.newton = force;
    return output = gate.Step(input);
  }
  const GateOutput& Run(int ticks, const math::Vec3& force = {}) {
    for (int i = 0; i < ticks; ++i) Step(force);
    return output;
  }
  void Arm() {
    gate.RequestArm();
    Run(2100);
    ASSERT_EQ(output.state, ArmState::kArmed);
  }
  double Size() const { return math::Norm(output.force.Get()); }
  ForceGate gate;
  GateInput input = Good();
  GateOutput output;
};

TEST(GateSettings, ComeFromTheDevicesLimits) {
  device::ForceLimits limits;
  limits.max_force = 8;
  EXPECT_EQ(MakeGateSettings(limits, 0.002).tick, 0.002);
  EXPECT_EQ(MakeGateSettings(limits, 0.001).max_force, 8);
  EXPECT_EQ(MakeGateSettings(limits, 0.001).max_continuous_force, 2) << "a quarter where it is not known";
  limits.max_continuous_force = 5;
  EXPECT_EQ(MakeGateSettings(limits, 0.001).max_continuous_force, 5);
  limits.max_continuous_force = 9;
  EXPECT_EQ(MakeGateSettings(limits, 0.001).max_continuous_force, 8);
  limits.max_continuous_force = 0.1;
  EXPECT_EQ(MakeGateSettings(limits, 0.001).max_continuous_force, 0.1);
}

// the numbers that docs/haptics.md promises, and that nothing holds before somebody says so
TEST(GateSettings, AreThoseThatArePromised) {
  const GateSettings settings;
  EXPECT_EQ(settings.tick, 0.001);
  EXPECT_EQ(settings.max_force, 0.0);
  EXPECT_EQ(settings.max_continuous_force, 0.0);
  EXPECT_EQ(settings.max_rise, 0.5);
  EXPECT_EQ(settings.implausible_factor, 20.0);
  EXPECT_EQ(settings.guard_speed, 1.0);
  EXPECT_EQ(settings.max_speed, 2.0);
  EXPECT_EQ(settings.heat_time, 20.0);
  EXPECT_EQ(settings.warm_temperature, 0.9);
  EXPECT_EQ(settings.ramp_time, 2.0);
  EXPECT_EQ(settings.short_ramp_time, 0.5);
  EXPECT_EQ(settings.short_fault_time, 1.0);
  EXPECT_EQ(settings.max_arming_force, 0.3);
  EXPECT_EQ(settings.arming_ticks, 4);
  EXPECT_EQ(settings.request_life, 0.5);
  const GateInput input;
  EXPECT_FALSE(input.conditions.is_supervised || input.conditions.is_calibrated ||
               input.conditions.is_pose_confirmed || input.conditions.is_dead_man_held ||
               input.conditions.is_simulation_healthy);
  EXPECT_FALSE(input.is_warm);
  EXPECT_EQ(input.temperature, 0.0);
  EXPECT_EQ(input.scale, 1.0);
  EXPECT_EQ(input.fault, Fault::kNone);
  const GateOutput output;
  EXPECT_EQ(output.force.Get(), math::Vec3{});
  EXPECT_EQ(output.state, ArmState::kUnarmed);
  EXPECT_EQ(output.limits, 0);
  EXPECT_EQ(output.heat, 0.0);
}

// the last look, each promise from both sides; what the stages before it let through is never refused here
TEST(MaySend, KnowsThePromises) {
  const GateSettings settings = Settings();
  const auto may = [&](const math::Vec3& force, const math::Vec3& sent, ArmState state = ArmState::kArmed) {
    return MaySend(settings, state, force, sent);
  };
  EXPECT_TRUE(may({}, {}, ArmState::kUnarmed)) << "zero at any time";
  EXPECT_TRUE(may({}, {3.3, 0, 0}, ArmState::kUnarmed));
  EXPECT_FALSE(may({0.01, 0, 0}, {}, ArmState::kUnarmed));
  EXPECT_TRUE(may({0.01, 0, 0}, {}, ArmState::kRamping));
  EXPECT_TRUE(may({0, 3.3, 0}, {0, 3.3, 0}));
  EXPECT_TRUE(may({0, 3.3 + 1e-10, 0}, {0, 3.3, 0})) << "rounding";
  EXPECT_FALSE(may({0, 3.3 + 1e-7, 0}, {0, 3.3, 0}));
  EXPECT_TRUE(may({0.5, 0, 0}, {}));
  EXPECT_TRUE(may({0.5 + 1e-10, 0, 0}, {}));
  EXPECT_FALSE(may({0.5 + 1e-7, 0, 0}, {}));
  EXPECT_TRUE(may({0.1, 0, 0}, {3, 0, 0})) << "a fall";
  EXPECT_FALSE(may({std::nan(""), 0, 0}, {}));
  EXPECT_FALSE(may({0.1, 0, 0}, {std::nan(""), 0, 0}));
}

TEST(ForceGate, WithoutUsableSettingsItNeverArms) {
  const auto is_broken = [](const auto& change) {
    GateSettings settings = Settings();
    change(settings);
    Gated gated(settings);
    gated.gate.RequestArm();
    gated.Run(3000);
    EXPECT_EQ(gated.Size(), 0.0);
    return gated.output.reason == Fault::kGate;
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_broken([](GateSettings&) {}));
  for (const double bad : {nan, inf, -1.0, 0.0}) {
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.max_force = bad; })) << bad;
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.max_continuous_force = bad; })) << bad;
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.guard_speed = bad; })) << bad;
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.max_speed = bad; })) << bad;
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.max_rise = -std::fabs(bad); })) << bad;
  }
  for (const double bad : {nan, -1.0, 0.0, 1.0}) {
    EXPECT_TRUE(is_broken([&](GateSettings& s) { s.tick = bad; })) << bad;
  }
  for (const double tick : {0.1, 0.11}) {
    EXPECT_EQ(is_broken([&](GateSettings& s) { s.tick = tick, s.max_rise = 2.0; }), tick > 0.1) << tick;
  }
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.max_force = 50.0; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_force = 50.1; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_continuous_force = 3.4; }));
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.max_continuous_force = 3.3; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_speed = s.guard_speed; }));
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.guard_speed = 0.01; }));
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.max_speed = 99.0; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_speed = 100.0; }));
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.max_force = 0.1, s.max_continuous_force = 0.01; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_force = 0.099, s.max_continuous_force = 0.01; }));
  EXPECT_FALSE(is_broken([](GateSettings& s) { s.max_rise = 0.01; }));
  EXPECT_TRUE(is_broken([](GateSettings& s) { s.max_rise = 0.002 * kMax; }));
}

TEST(ForceGate, ArmsAfterFourGoodTicksInARow) {
  Gated gated;
  gated.Run(20);
  EXPECT_EQ(gated.output.reason, Fault::kNotRequested);
  gated.gate.RequestArm();
  gated.Run(3);
  EXPECT_EQ(gated.output.state, ArmState::kUnarmed);
  gated.Step();
  EXPECT_EQ(gated.output.state, ArmState::kRamping);
  EXPECT_EQ(gated.output.reason, Fault::kNone);
  // a condition that breaks takes the wish with it, and the next wish counts from none
  Gated broken;
  broken.gate.RequestArm();
  broken.Run(3);
  broken.input.conditions.is_dead_man_held = false;
  broken.Step();
  broken.input.conditions.is_dead_man_held = true;
  broken.Run(10);
  EXPECT_EQ(broken.output.state, ArmState::kUnarmed);
  broken.gate.RequestArm();
  broken.Run(3);
  EXPECT_EQ(broken.output.state, ArmState::kUnarmed);
  EXPECT_EQ(broken.Step().state, ArmState::kRamping);
}

TEST(ForceGate, ArmsAgainstLessThanThreeTenthsOfANewton) {
  Gated free;
  free.gate.RequestArm();
  EXPECT_EQ(free.Run(4, {0.299, 0, 0}).state, ArmState::kRamping);
  Gated edge;
  edge.gate.RequestArm();
  EXPECT_EQ(edge.Run(10, {0.3, 0, 0}).state, ArmState::kUnarmed);
  Gated pressed;
  pressed.gate.RequestArm();
  pressed.Run(4, {0, 0.301, 0});
  EXPECT_EQ(pressed.output.state, ArmState::kUnarmed);
  EXPECT_EQ(pressed.output.reason, Fault::kForceAtArming);
  // four ticks from the last pressed one on
  pressed.Run(3, {0, 0, 0});
  pressed.Step({0, 0.301, 0});
  pressed.Run(3);
  EXPECT_EQ(pressed.output.state, ArmState::kUnarmed);
  EXPECT_EQ(pressed.Step().state, ArmState::kRamping);
}

TEST(ForceGate, AWishLapsesAfterHalfASecond) {
  for (const int waited : {495, 505}) {
    Gated gated;
    gated.gate.RequestArm();
    gated.Run(waited, {1, 0, 0});
    gated.Run(10);
    EXPECT_EQ(gated.output.state, waited < 497 ? ArmState::kRamping : ArmState::kUnarmed) << waited;
  }
  // asked while armed: no wish that lies in wait for the next fault
  Gated armed;
  armed.Arm();
  armed.gate.RequestArm();
  armed.gate.Stop();
  armed.Run(10);
  EXPECT_EQ(armed.output.state, ArmState::kUnarmed);
  EXPECT_EQ(armed.output.reason, Fault::kStopped);
}

// no wish outlives a fault, not even one of a single tick
TEST(ForceGate, AFaultEndsTheWish) {
  GateSettings settings = Settings();
  settings.arming_ticks = 1;
  Gated gated(settings);
  gated.gate.RequestArm();
  gated.input.fault = Fault::kJump;
  gated.Step();
  gated.input.fault = Fault::kNone;
  gated.Run(5);
  EXPECT_EQ(gated.output.state, ArmState::kUnarmed);
  EXPECT_EQ(gated.output.reason, Fault::kJump) << "why it is not armed stays told";
  EXPECT_EQ(Gated(settings).Step().state, ArmState::kUnarmed) << "and without a wish nothing begins";
  // and one that comes in the middle of a ramp, too
  gated.gate.RequestArm();
  gated.Step();
  ASSERT_EQ(gated.output.state, ArmState::kRamping);
  gated.input.fault = Fault::kSilent;
  gated.Step({0.2, 0, 0});
  EXPECT_EQ(gated.output.state, ArmState::kUnarmed);
  EXPECT_EQ(gated.Size(), 0.0);
}

// without force nothing drives the device on, however fast a person moves it
TEST(ForceGate, UnarmedASpeedIsNoFault) {
  Gated gated;
  gated.Arm();
  gated.Run(30, {1, 0, 0});
  gated.gate.Stop();
  gated.Step({1, 0, 0});
  gated.input.velocity = {5, 0, 0};
  gated.Run(3);
  EXPECT_EQ(gated.output.reason, Fault::kStopped);
}

TEST(ForceGate, TheRampIsEvenAndTwoSecondsLong) {
  Gated gated;
  gated.gate.RequestArm();
  gated.Run(4);
  for (int tick = 1; tick <= 2000; ++tick) {
    gated.Step({0.4, 0, 0});
    ASSERT_NEAR(gated.Size(), 0.4 * tick / 2000.0, 1e-9) << tick;
    if (tick < 2000) {
      ASSERT_EQ(gated.output.state, ArmState::kRamping) << tick;
    }
  }
  // a tick more for what two thousand sums are short of one
  EXPECT_EQ(gated.Step({0.4, 0, 0}).state, ArmState::kArmed);
}

TEST(ForceGate, AfterAFaultOfUpToASecondTheRampIsHalfASecond) {
  for (const int away : {20, 999, 1000, 1010}) {
    Gated gated;
    gated.Arm();
    gated.Step();
    gated.input.conditions.is_dead_man_held = false;
    gated.Run(away - 3);
    gated.input.conditions.is_dead_man_held = true;
    gated.gate.RequestArm();
    gated.Run(4);
    ASSERT_EQ(gated.output.state, ArmState::kRamping);
    gated.Run(499);
    EXPECT_EQ(gated.output.state, ArmState::kRamping) << away;
    gated.Run(2);
    EXPECT_EQ(gated.output.state, away < 1000 ? ArmState::kArmed : ArmState::kRamping) << away;
  }
  // broken off before it was whole, a ramp is no reason for a short one
  Gated halfway;
  halfway.gate.RequestArm();
  halfway.Run(500);
  halfway.gate.Stop();
  halfway.Step();
  halfway.gate.RequestArm();
  halfway.Run(600);
  EXPECT_EQ(halfway.output.state, ArmState::kRamping);
}

TEST(ForceGate, AShortRampThatBreaksOffIsFollowedByALongOne) {
  Gated gated;
  gated.Arm();
  gated.Step();
  for (int i = 0; i < 2; ++i) {
    gated.gate.Stop();
    gated.Step();
    gated.gate.RequestArm();
    gated.Run(104);
    ASSERT_EQ(gated.output.state, ArmState::kRamping);
  }
  gated.Run(600);
  EXPECT_EQ(gated.output.state, ArmState::kRamping);
}

TEST(ForceGate, ClampsAndLimitsTheRise) {
  Gated gated;
  gated.Arm();
  // what the scales may add is taken off: 0.5 - 0.002 x 3.3
  const double rise = 0.5 - 0.001 / 0.5 * kMax;
  for (int tick = 1; tick <= 10; ++tick) {
    gated.Step({0, -5, 0});
    ASSERT_NEAR(gated.Size(), std::fmin(kMax, tick * rise), 1e-9) << tick;
    EXPECT_EQ((gated.output.limits & kClamped) != 0, true);
    EXPECT_EQ((gated.output.limits & kRiseLimited) != 0, tick * rise < kMax) << tick;
  }
  EXPECT_LT(gated.output.force.Get().y, 0.0) << "its direction stays";
  EXPECT_NEAR(gated.Step({0, -1, 0}).force.Get().y, -1.0, 1e-12) << "a fall is free";
  EXPECT_EQ(gated.output.limits, 0);
  EXPECT_NEAR(gated.Step({0, 1, 0}).force.Get().y, rise, 1e-9) << "through zero";
  // the largest force itself is not clamped
  GateSettings two = Settings();
  two.max_force = 2;
  Gated edge(two);
  edge.Arm();
  edge.Run(10, {0, 2, 0});
  EXPECT_EQ(edge.Size(), 2.0);
  EXPECT_EQ(edge.output.limits, 0);
}

TEST(ForceGate, UnarmedItLimitsNothing) {
  Gated gated;
  gated.input.is_warm = true;
  EXPECT_EQ(gated.Run(3, {5, 0, 0}).limits, 0);
  EXPECT_EQ(gated.output.heat, 0.0);
}

TEST(ForceGate, RefusesWhatNoTissueGives) {
  const double nan = std::nan("");
  const auto reason = [](const math::Vec3& force, const auto& change) {
    Gated gated;
    gated.Arm();
    gated.Run(30, {1, 0, 0});
    EXPECT_GT(gated.Size(), 0.9);
    change(gated.input);
    gated.Step(force);
    if (gated.output.reason != Fault::kNone) {
      EXPECT_EQ(gated.Size(), 0.0);
      EXPECT_EQ(gated.output.state, ArmState::kUnarmed);
      EXPECT_EQ(gated.output.limits, 0);
      gated.input = Good();
      gated.Run(700, {0.1, 0, 0});
      EXPECT_EQ(gated.Size(), 0.0) << "latched";
    }
    return gated.output.reason;
  };
  using Change = std::function<void(GateInput&)>;
  const Change none = [](GateInput&) {};
  const math::Vec3 one{1, 0, 0};
  EXPECT_EQ(reason(one, Change(none)), Fault::kNone);
  EXPECT_EQ(reason({nan, 0, 0}, Change(none)), Fault::kForceNotFinite);
  EXPECT_EQ(reason({0, 20 * kMax, 0}, Change(none)), Fault::kNone) << "20 times 3.3";
  EXPECT_EQ(reason({0, 66.1, 0}, Change(none)), Fault::kForceImplausible);
  EXPECT_EQ(reason(one, Change([&](GateInput& i) { i.scale = nan; })), Fault::kForceNotFinite);
  EXPECT_EQ(reason(one, Change([&](GateInput& i) { i.velocity.z = nan; })), Fault::kBadSamples);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.temperature = 0.999; })), Fault::kNone);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.temperature = 1.0; })), Fault::kOverheated);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.fault = Fault::kJump; })), Fault::kJump);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.conditions.is_supervised = false; })),
            Fault::kSupervisor);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.conditions.is_calibrated = false; })),
            Fault::kNotCalibrated);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.conditions.is_pose_confirmed = false; })),
            Fault::kPoseUnconfirmed);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.conditions.is_dead_man_held = false; })),
            Fault::kDeadMan);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.conditions.is_simulation_healthy = false; })),
            Fault::kSimulation);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.velocity.x = 1.99; })), Fault::kNone);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.velocity.x = 2.0; })), Fault::kOverspeed);
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.velocity.x = -5.0; })), Fault::kNone)
      << "against the force";
  EXPECT_EQ(reason(one, Change([](GateInput& i) { i.velocity.y = 5.0; })), Fault::kNone) << "across it";
  // a weak force is a force, none is none
  for (const double scale : {0.1, 0.0}) {
    Gated gated;
    gated.Arm();
    gated.input.scale = scale;
    gated.Run(30, {1, 0, 0});
    gated.input.velocity.x = 2.0;
    gated.Step({1, 0, 0});
    EXPECT_EQ(gated.output.reason, scale > 0.0 ? Fault::kOverspeed : Fault::kNone);
  }
  Gated weak;
  weak.Arm();
  weak.Run(30, {0.1, 0, 0});
  weak.input.velocity.x = 2.0;
  EXPECT_EQ(weak.Step({0.1, 0, 0}).reason, Fault::kOverspeed);
}

TEST(ForceGate, AForceThatDrivesTheDeviceOnFadesFromOneMetreASecond) {
  const struct {
    double speed, share;
  } cases[] = {{0.99, 1.0}, {1.25, 0.75}, {1.5, 0.5}, {1.9, 0.1}, {-1.9, 1.0}};
  for (const auto& wanted : cases) {
    Gated gated;
    gated.Arm();
    gated.Run(30, {1, 0, 0});
    gated.input.velocity = {wanted.speed, 0, 0};
    gated.Step({1, 0, 0});
    EXPECT_NEAR(gated.Size(), wanted.share, 1e-9) << wanted.speed;
    EXPECT_EQ((gated.output.limits & kSpeedLimited) != 0, wanted.share < 1.0);
    // back by a five-hundredth a tick, not at once
    gated.input.velocity = {};
    gated.Step({1, 0, 0});
    EXPECT_NEAR(gated.Size(), std::fmin(1.0, wanted.share + 0.002), 1e-9);
  }
  Gated weak;
  weak.Arm();
  weak.Run(30, {0.1, 0, 0});
  weak.input.velocity = {1.5, 0, 0};
  EXPECT_NEAR(math::Norm(weak.Step({0.1, 0, 0}).force.Get()), 0.05, 1e-9);
  GateSettings wide = Settings();
  wide.guard_speed = 0.5;
  Gated early(wide);
  early.Arm();
  early.Run(30, {1, 0, 0});
  early.input.velocity = {1.25, 0, 0};
  EXPECT_NEAR(math::Norm(early.Step({1, 0, 0}).force.Get()), 0.5, 1e-9) << "half way from 0.5 to 2 m/s";
  weak.input.velocity = {0, 1.5, 0};
  weak.Run(300, {0.1, 0, 0});
  EXPECT_NEAR(weak.Size(), 0.1, 1e-9) << "across the force";
}

TEST(ForceGate, TheGuardsScaleFallsAtOnceAndRisesSlowly) {
  Gated gated;
  gated.Arm();
  gated.Run(30, {1, 0, 0});
  gated.input.scale = 0.5;
  EXPECT_NEAR(math::Norm(gated.Step({1, 0, 0}).force.Get()), 0.5, 1e-9);
  gated.input.scale = 7.0;
  gated.Run(100, {1, 0, 0});
  EXPECT_NEAR(gated.Size(), 0.7, 1e-6);
  gated.Run(400, {1, 0, 0});
  EXPECT_NEAR(gated.Size(), 1.0, 1e-9) << "never above what is wanted";
  gated.input.scale = -1.0;
  EXPECT_EQ(math::Norm(gated.Step({1, 0, 0}).force.Get()), 0.0);
}

TEST(ForceGate, HeatFollowsTheSquareOfTheLoadInTwentySeconds) {
  Gated gated;
  gated.Arm();
  double heat = gated.output.heat;
  EXPECT_EQ(heat, 0.0);
  for (int tick = 0; tick < 3000; ++tick) {
    gated.Step({0.5, 0, 0});
    const double load = gated.Size() / kContinuous;
    heat += 0.001 / 20.0 * (load * load - heat);
    ASSERT_NEAR(gated.output.heat, heat, 1e-9);
  }
}

TEST(ForceGate, HotMotorsBearLess) {
  // derated between a heat of 0.8 and 1, from the largest force to the continuous one
  Gated hot;
  hot.Arm();
  hot.Run(20, {3, 0, 0});
  while (hot.output.heat < 0.8) {
    ASSERT_NEAR(hot.Size(), 3.0, 1e-9);
    hot.Step({3, 0, 0});
  }
  double before = hot.output.heat;
  for (int i = 0; i < 20'000; ++i) {
    hot.Step({3, 0, 0});
    const double room = (1.0 - before) / 0.2;
    const double allowed = kContinuous + (kMax - kContinuous) * room;
    ASSERT_NEAR(hot.Size(), std::fmin(3.0, allowed), 1e-6);
    before = hot.output.heat;
  }
  // warm by its own word, or from nine tenths of its temperature: half of the continuous force
  for (const bool by_word : {false, true}) {
    Gated warm;
    warm.Arm();
    warm.Run(30, {1, 0, 0});
    warm.input.temperature = 0.899;
    EXPECT_NEAR(math::Norm(warm.Step({1, 0, 0}).force.Get()), 1.0, 1e-9);
    if (by_word)
      warm.input.is_warm = true;
    else
      warm.input.temperature = 0.9;
    EXPECT_NEAR(math::Norm(warm.Step({1, 0, 0}).force.Get()), 0.5 * kContinuous, 1e-9);
    EXPECT_NE(warm.output.limits & kHeatLimited, 0);
    // less than that is not touched
    warm.Run(600, {0.2, 0, 0});
    EXPECT_NEAR(warm.Size(), 0.2, 1e-9);
    EXPECT_EQ(warm.output.limits & kHeatLimited, 0);
  }
}

TEST(ArmStates, HaveNames) {
  EXPECT_EQ(ArmStateName(ArmState::kUnarmed), "unarmed");
  EXPECT_EQ(ArmStateName(ArmState::kRamping), "ramping");
  EXPECT_EQ(ArmStateName(ArmState::kArmed), "armed");
}

// --- the channel round it

TEST(HapticChannel, TissueOlderThanATenthOfASecondIsNone) {
  for (const int old : {99, 102}) {
    HapticRig rig;
    rig.ArmAndPress(1.0);
    rig.channel.TakePatch(rig.patch, rig.now);
    rig.ticks = 1;  // of eight: the next patch comes with the eighth tick from here
    for (int i = 0; i < old; ++i) {
      rig.now += HapticRig::kTick;
      ++rig.sample.sequence;
      rig.channel.Read(rig.sample, rig.now);
      rig.output = rig.channel.Act({{}, rig.channel.CalcHand()}, rig.loop.Step(0), rig.conditions, rig.now);
    }
    EXPECT_EQ(rig.output.gate.reason, old > 100 ? Fault::kSimulation : Fault::kNone) << old;
  }
}

TEST(HapticChannel, APedalTakesTheSwitchsPlaceAndTheMaskSaysWhichButton) {
  HapticRig rig;
  rig.ArmAndPress(1.0);
  rig.conditions.is_pedal_held = true;
  rig.sample.buttons = 0;
  rig.Run(3);
  EXPECT_EQ(rig.output.gate.state, ArmState::kArmed);
  rig.conditions.is_pedal_held = false;
  rig.Forbid();
  rig.sample.buttons = 2;
  rig.Tick();
  EXPECT_EQ(rig.output.gate.reason, Fault::kDeadMan) << "another button is no switch";
  EXPECT_EQ(rig.complaint, "");
}

TEST(HapticChannel, WithoutAPoseThereIsNoTool) {
  HapticRig rig;
  rig.sample.position.x = std::nan("");
  rig.Run(10);
  EXPECT_FALSE(rig.output.has_pose);
  rig.sample.position.x = 0;
  rig.Run(1);
  EXPECT_TRUE(rig.output.has_pose);
  HapticRig pressed;
  pressed.Run(20);
  pressed.Press(std::nan(""));
  pressed.is_patch_new = true;
  pressed.Run(1);
  EXPECT_FALSE(pressed.output.has_pose) << "a force that is no number has no place either";
  EXPECT_EQ(pressed.output.gate.reason, Fault::kForceNotFinite);
  pressed.Run(1);
  EXPECT_EQ(pressed.output.gate.reason, Fault::kSimulation) << "what made it so is forgotten with its tissue";
  EXPECT_EQ(pressed.output.local.force, math::Vec3{});
}

// tissue that is no longer so, or that a device came away from, presses nobody
TEST(HapticChannel, ForgetsTissueThatIsBadOrWasLeft) {
  for (const bool is_left : {false, true}) {
    HapticRig rig;
    rig.ArmAndPress(1.0);
    rig.Run(8);
    ASSERT_GT(rig.output.local.force.x, 0.5);
    rig.Forbid();
    if (is_left) {
      rig.sample.status = device::ForceDeviceStatus::kLost;
    } else {
      rig.patch.is_healthy = false;
      rig.is_patch_new = true;
    }
    rig.ticks = 1;  // of eight, so that none comes by itself
    rig.Tick();
    rig.sample.status = device::ForceDeviceStatus::kOk;
    rig.Tick();
    EXPECT_TRUE(rig.output.has_pose);
    EXPECT_EQ(rig.output.local.force, math::Vec3{});
    EXPECT_EQ(rig.complaint, "");
  }
}

}  // namespace
}  // namespace trocar::haptics
