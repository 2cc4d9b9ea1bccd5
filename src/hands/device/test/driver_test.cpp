// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/driver.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "trocar/device/simulated_force_device.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

/// Counts its calls and fails where it is told to.
class MockDriver : public Driver {
 public:
  MockDriver() : Driver("mock", 2) {}
  bool fails_configure = false, fails_activate = false;
  ReadStatus next = ReadStatus::kFresh;
  std::vector<std::string> calls;

 private:
  base::Status DoConfigure() override {
    calls.push_back("configure");
    if (fails_configure) return base::Error{ErrorCode::kDeviceLost, "no such device: plug it in"};
    return {};
  }
  base::Status DoActivate() override {
    calls.push_back("activate");
    if (fails_activate) return base::Error{ErrorCode::kDeviceStale, "no data: switch it on"};
    return {};
  }
  void DoDeactivate() noexcept override { calls.push_back("deactivate"); }
  void DoCleanup() noexcept override { calls.push_back("cleanup"); }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override {
    for (HandSample& sample : samples) sample.is_valid = true;
    return next;
  }
};

TEST(Driver, WalksThroughItsLifeInOrder) {
  MockDriver driver;
  EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_EQ(driver.GetState(), DriverState::kInactive);
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(driver.GetState(), DriverState::kActive);
  ASSERT_TRUE(driver.Deactivate().ok());
  ASSERT_TRUE(driver.Cleanup().ok());
  EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
  EXPECT_EQ(driver.calls, (std::vector<std::string>{"configure", "activate", "deactivate", "cleanup"}));
}

/// Counts its calls, and is lost when it is told so.
class MockForceDriver : public ForceDriver {
 public:
  MockForceDriver() : ForceDriver("mock", 2) {}
  ForceLimits GetLimits(int) const noexcept override { return limits; }
  ForceLimits limits = MakeTouchLimits();
  ReadStatus next = ReadStatus::kFresh;
  std::vector<std::string> calls;

 private:
  base::Status DoConfigure() override { return calls.push_back("configure"), base::Status{}; }
  base::Status DoActivate() override { return calls.push_back("activate"), base::Status{}; }
  void DoDeactivate() noexcept override { calls.push_back("deactivate"); }
  void DoCleanup() noexcept override { calls.push_back("cleanup"); }
  ReadStatus DoRead(std::span<HandSample>) noexcept override { return next; }
  ReadStatus DoReadForceSamples(std::span<ForceSample> samples) noexcept override {
    for (ForceSample& sample : samples) sample.status = ForceDeviceStatus::kOk;
    return next;
  }
  void DoSendForce(int channel, const GatedForce& force) noexcept override {
    EXPECT_EQ(force.Get(), math::Vec3{});
    calls.push_back("send " + std::to_string(channel));
  }
};

// what reads a thousand times a second closes nothing: a library may take its time
TEST(ForceDriver, ALostDeviceGetsZeroAndIsClosedLater) {
  using Calls = std::vector<std::string>;
  for (const int way : {0, 1, 2}) {
    MockForceDriver driver;
    std::array<ForceSample, 2> samples;
    EXPECT_EQ(driver.ReadForceSamples(samples), ReadStatus::kNotActive);
    EXPECT_EQ(samples[1].status, ForceDeviceStatus::kLost);
    driver.SendForce(0, {});
    EXPECT_EQ(driver.calls, Calls{}) << "nothing before it is active";
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    EXPECT_EQ(driver.ReadForceSamples(samples), ReadStatus::kFresh);
    EXPECT_EQ(samples[0].status, ForceDeviceStatus::kOk);
    EXPECT_FALSE(driver.NeedsRelease());
    driver.Release();
    driver.SendForce(1, {});
    EXPECT_EQ(driver.calls, (Calls{"configure", "activate", "send 1"}));
    driver.next = ReadStatus::kLost;
    driver.calls.clear();
    EXPECT_EQ(driver.ReadForceSamples(samples), ReadStatus::kLost);
    EXPECT_EQ(samples[0].status, ForceDeviceStatus::kLost);
    EXPECT_EQ(samples[1].status, ForceDeviceStatus::kLost);
    EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
    EXPECT_TRUE(driver.NeedsRelease());
    EXPECT_EQ(driver.ReadForceSamples(samples), ReadStatus::kNotActive);
    EXPECT_EQ(driver.calls, (Calls{"send 0", "send 1"})) << "zero to each, and no more";
    driver.calls.clear();
    driver.next = ReadStatus::kFresh;
    if (way == 0) driver.Release(), driver.Release();
    if (way == 1) {
      ASSERT_TRUE(driver.Configure().ok());
    }
    if (way == 2) driver.Finalize();
    EXPECT_FALSE(driver.NeedsRelease());
    Calls expected{"deactivate", "cleanup"};
    if (way == 1) expected.push_back("configure");
    EXPECT_EQ(driver.calls, expected);
  }
}

// what was opened is closed again where its limits are refused
TEST(ForceDriver, ARefusedDeviceIsClosed) {
  MockForceDriver driver;
  driver.limits.max_force = 251;
  EXPECT_EQ(driver.Configure().error().code, ErrorCode::kDeviceSettings);
  EXPECT_EQ(driver.calls, (std::vector<std::string>{"configure", "cleanup"}));
  EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
  driver.Finalize();
  EXPECT_EQ(driver.calls.size(), 2u);
}

// every family, in every build: the base class asks
TEST(ForceDriver, IsNotOpenedWithLimitsThatNoHandHolds) {
  const double nan = std::nan("");
  const auto configure = [](const auto& change) {
    SimulatedForceSettings settings;
    settings.path = [](int, double) { return math::Vec3{}; };
    settings.limits = MakeTouchLimits();
    change(settings.limits);
    SimulatedForceDevice device(settings);
    const base::Status done = device.Configure();
    EXPECT_EQ(device.GetState(), done.ok() ? DriverState::kInactive : DriverState::kUnconfigured);
    return done.ok() ? ErrorCode::kNone : done.error().code;
  };
  EXPECT_EQ(configure([](ForceLimits&) {}), ErrorCode::kNone);
  EXPECT_EQ(configure([](ForceLimits& limits) { limits.max_force = kLargestForceLimit; }), ErrorCode::kNone);
  EXPECT_EQ(configure([](ForceLimits& limits) { limits.max_force = kSmallestForceLimit; }), ErrorCode::kNone);
  EXPECT_EQ(configure([](ForceLimits& limits) {
              limits = {};
              limits.max_force = 3.3;
            }),
            ErrorCode::kNone)
      << "what is not known is 0";
  EXPECT_EQ(configure([](ForceLimits& limits) {
              limits.max_force = limits.max_continuous_force = 50;
              limits.max_stiffness = 100'000, limits.damping = 100, limits.friction = 10, limits.mass = 10;
              limits.position_step = 0.01;
              limits.workspace_min = {-3, -3, -3}, limits.workspace_max = {3, 3, 3};
            }),
            ErrorCode::kNone)
      << "the largest of everything";
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(configure([&](ForceLimits& limits) { limits.workspace_min[axis] = -3.01; }),
              ErrorCode::kDeviceSettings);
    EXPECT_EQ(configure([&](ForceLimits& limits) { limits.workspace_max[axis] = 3.01; }),
              ErrorCode::kDeviceSettings);
  }
  double ForceLimits::*const numbers[] = {&ForceLimits::max_force,     &ForceLimits::max_continuous_force,
                                          &ForceLimits::max_stiffness, &ForceLimits::damping,
                                          &ForceLimits::friction,      &ForceLimits::mass,
                                          &ForceLimits::position_step};
  for (const auto number : numbers) {
    for (const double bad : {nan, -1.0, 1e6, 1e308, std::numeric_limits<double>::infinity()})
      EXPECT_EQ(configure([&](ForceLimits& limits) { limits.*number = bad; }), ErrorCode::kDeviceSettings)
          << bad;
  }
  const std::pair<double ForceLimits::*, double> largest[] = {{&ForceLimits::max_continuous_force, 50},
                                                              {&ForceLimits::max_stiffness, 100'000},
                                                              {&ForceLimits::damping, 100},
                                                              {&ForceLimits::friction, 10},
                                                              {&ForceLimits::mass, 10},
                                                              {&ForceLimits::position_step, 0.01}};
  for (const auto& [number, limit] : largest) {
    for (const double share : {1.0, 1.001}) {
      EXPECT_EQ(
          configure([&, part = number, value = share * limit](ForceLimits& limits) { limits.*part = value; }),
          share > 1.0 ? ErrorCode::kDeviceSettings : ErrorCode::kNone)
          << share * limit;
    }
  }
  EXPECT_EQ(configure([](ForceLimits& limits) { limits.max_force = 50.001; }), ErrorCode::kDeviceSettings);
  EXPECT_EQ(configure([](ForceLimits& limits) { limits.max_force = 0.099; }), ErrorCode::kDeviceSettings);
  EXPECT_EQ(configure([](ForceLimits& limits) { limits.workspace_min.y = 0.1; }), ErrorCode::kDeviceSettings)
      << "inside out";
  EXPECT_EQ(configure([&](ForceLimits& limits) { limits.workspace_max.z = nan; }),
            ErrorCode::kDeviceSettings);
}

TEST(Driver, RefusesEveryTransitionOutOfTurn) {
  const auto refuses = [](const base::Status& status) {
    return !status.ok() && status.error().code == ErrorCode::kDeviceState;
  };
  MockDriver driver;
  EXPECT_TRUE(refuses(driver.Activate()));
  EXPECT_TRUE(refuses(driver.Deactivate()));
  EXPECT_TRUE(refuses(driver.Cleanup()));
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_TRUE(refuses(driver.Configure()));
  EXPECT_TRUE(refuses(driver.Deactivate()));
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_TRUE(refuses(driver.Configure()));
  EXPECT_TRUE(refuses(driver.Activate()));
  EXPECT_TRUE(refuses(driver.Cleanup()));
  driver.Finalize();
  EXPECT_TRUE(refuses(driver.Configure()));
  EXPECT_TRUE(refuses(driver.Activate()));
  EXPECT_EQ(driver.calls, (std::vector<std::string>{"configure", "activate", "deactivate", "cleanup"}))
      << "a refused wish must not reach the device";
}

TEST(Driver, MessageSaysWhatToDoFirst) {
  MockDriver driver;
  EXPECT_EQ(driver.Activate().error().Text(),
            "E-DEV-003 mock is unconfigured and cannot be activated: it must be inactive first");
}

TEST(Driver, FailedStepLeavesTheStateAsItWas) {
  MockDriver driver;
  driver.fails_configure = true;
  EXPECT_EQ(driver.Configure().error().code, ErrorCode::kDeviceLost);
  EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
  driver.fails_configure = false;
  driver.fails_activate = true;
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_EQ(driver.Activate().error().code, ErrorCode::kDeviceStale);
  EXPECT_EQ(driver.GetState(), DriverState::kInactive);
}

TEST(Driver, ReadsOnlyWhileActive) {
  MockDriver driver;
  std::array<HandSample, 2> samples;
  samples[1].is_valid = true;
  EXPECT_EQ(driver.Read(samples), ReadStatus::kNotActive);
  EXPECT_FALSE(samples[1].is_valid);
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_EQ(driver.Read(samples), ReadStatus::kNotActive);
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(driver.Read(samples), ReadStatus::kFresh);
  EXPECT_TRUE(samples[0].is_valid && samples[1].is_valid);
}

TEST(Driver, LostDeviceIsClosedAndComesBackOnlyWhenConfiguredAgain) {
  MockDriver driver;
  std::array<HandSample, 2> samples;
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  driver.next = ReadStatus::kLost;
  EXPECT_EQ(driver.Read(samples), ReadStatus::kLost);
  EXPECT_FALSE(samples[0].is_valid || samples[1].is_valid);
  EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
  EXPECT_FALSE(driver.NeedsRelease());
  EXPECT_EQ(driver.calls, (std::vector<std::string>{"configure", "activate", "deactivate", "cleanup"}));
  driver.next = ReadStatus::kFresh;
  EXPECT_EQ(driver.Read(samples), ReadStatus::kNotActive);
  EXPECT_TRUE(driver.Configure().ok());
  EXPECT_TRUE(driver.Activate().ok());
  EXPECT_EQ(driver.Read(samples), ReadStatus::kFresh);
}

TEST(Driver, FinalizesOnce) {
  MockDriver driver;
  driver.Finalize();
  driver.Finalize();
  EXPECT_EQ(driver.GetState(), DriverState::kFinalized);
  EXPECT_TRUE(driver.calls.empty());
  MockDriver inactive;
  ASSERT_TRUE(inactive.Configure().ok());
  inactive.Finalize();
  EXPECT_EQ(inactive.calls, (std::vector<std::string>{"configure", "cleanup"}))
      << "only what was opened is closed";
}

}  // namespace
}  // namespace trocar::device
