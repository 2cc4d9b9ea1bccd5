// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/open_haptics.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "hands/force_mailbox.h"
#include "openhaptics/hd_devices.h"
#include "stand_in_gate.h"
#include "stand_in_hd.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/ports.h"
#include "trocar/host/clock.h"
#include "trocar/math/rotation_angle.h"
#include "wait_for.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

class OpenHapticsTest : public testing::Test {
 protected:
  void SetUp() override {
    settings_.hd_file = TROCAR_STAND_IN_HD;
    settings_.names = {"Left", "Right"};
    // held open, so that its counters can be asked after the driver has let go
    library_ = ::dlopen(TROCAR_STAND_IN_HD, RTLD_NOW);
    ASSERT_NE(library_, nullptr) << ::dlerror();
  }
  void TearDown() override { ::dlclose(library_); }
  template <typename Function>
  Function* Find(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }
  math::Vec3 Force(int device) {
    std::array<double, 3> force{};
    Find<void(int, double*)>("StandInForce")(device, force.data());
    return {force[0], force[1], force[2]};
  }
  void Raise(unsigned int error) { Find<void(unsigned int)>("StandInRaise")(error); }
  OpenHapticsSettings settings_;
  void* library_ = nullptr;
};

/// The library's scheduler calls when the test says so.
class SteppedLibrary : public OpenHapticsTest {
 protected:
  void SetUp() override {
    OpenHapticsTest::SetUp();
    Find<void(int)>("StandInStepped")(1);
  }
  void TearDown() override {
    EXPECT_EQ(Find<int()>("StandInMisuses")(), 0) << "frames, order of devices and scheduler";
    EXPECT_EQ(Find<int()>("StandInDevices")(), 0);
    Find<void(int)>("StandInStepped")(0);
    OpenHapticsTest::TearDown();
  }
  void Step() { Find<void()>("StandInStep")(); }
  void Fail(StandInFault fault) { Find<void(int)>("StandInFail")(static_cast<int>(fault)); }
};

TEST_F(OpenHapticsTest, ReadsTwoDevicesInSiUnits) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_EQ(driver.GetChannelCount(), 2);
  EXPECT_EQ(driver.GetLimits(0).max_force, 3.3);
  EXPECT_EQ(driver.GetLimits(0).max_continuous_force, 0.88);
  EXPECT_EQ(driver.GetLimits(-1).max_force, 0.0);
  EXPECT_EQ(driver.GetLimits(2).max_force, 0.0);
  EXPECT_NEAR(driver.GetLimits(1).max_stiffness, 1020, 1e-9) << "N/m";
  EXPECT_EQ(driver.GetLimits(1).damping, 0.2) << "what the library does not say is assumed";
  EXPECT_EQ(driver.GetLimits(1).friction, 0.06);
  EXPECT_EQ(driver.GetLimits(1).position_step, 0.055e-3);
  EXPECT_NEAR(math::Distance(driver.GetLimits(1).workspace_min, {-0.08, -0.06, -0.035}), 0, 1e-12);
  EXPECT_NEAR(math::Distance(driver.GetLimits(1).workspace_max, {0.08, 0.06, 0.035}), 0, 1e-12);
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor([&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  EXPECT_NEAR(samples[0].position.x, -0.04, 1e-12);
  EXPECT_NEAR(samples[1].position.x, 0.04, 1e-12);
  EXPECT_NEAR(samples[0].position.y, -0.01, 1e-12);
  EXPECT_NEAR(samples[0].position.z, 0.005, 1e-12);
  EXPECT_NEAR(samples[0].velocity.x, 0.1, 1e-12);
  EXPECT_EQ(samples[0].buttons, 1u);
  EXPECT_EQ(samples[1].temperature, 0.4);
  EXPECT_TRUE(samples[0].is_calibrated);
  EXPECT_EQ(samples[0].status, ForceDeviceStatus::kOk);
  EXPECT_TRUE(std::isnan(samples[0].jaw)) << "it has no gripper";
  const std::uint64_t before = samples[0].sequence;
  ASSERT_TRUE(WaitFor([&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  EXPECT_GT(samples[0].sequence, before);
  std::array<HandSample, 2> hands;
  driver.Read(hands);
  EXPECT_EQ(hands[0].jaw, 0.0) << "the button is held";
  EXPECT_GT(hands[1].jaw, 0.5);
  EXPECT_GT(hands[0].pan, 0.1) << "to the left";
  EXPECT_LT(hands[1].pan, -0.1);
  driver.Finalize();
  EXPECT_EQ(Find<int()>("StandInMisuses")(), 0) << "frames, order of devices and scheduler";
  EXPECT_EQ(Find<int()>("StandInDevices")(), 0);
}

// what a library says of its device is refused when it is opened, in every build
TEST_F(OpenHapticsTest, RefusesImplausibleLimits) {
  const auto limits = Find<void(const double*)>("StandInLimits");
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const double figures[][3] = {{251, 0.88, 1.02}, {1e308, 0.88, 1.02}, {nan, 0.88, 1.02}, {inf, 1, 1},
                               {-3.3, 0.88, 1},   {0, 0, 0},           {0.09, 0.01, 1},   {3.3, nan, 1},
                               {3.3, -1, 1},      {3.3, 0.88, inf},    {3.3, 0.88, nan},  {3.3, 0.88, -1}};
  for (const auto& figure : figures) {
    limits(figure);
    OpenHaptics driver(settings_);
    const base::Status refused = driver.Configure();
    ASSERT_FALSE(refused.ok()) << figure[0] << ' ' << figure[1] << ' ' << figure[2];
    EXPECT_EQ(refused.error().code, ErrorCode::kDeviceSettings);
    EXPECT_NE(refused.error().message.find("maker's program"), std::string::npos);
    EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
    EXPECT_EQ(Find<int()>("StandInDevices")(), 0) << "what was open is closed";
  }
  for (const double good : {0.1, 3.3, 50.0}) {
    const double figure[3] = {good, 0.0, 1.02};
    limits(figure);
    OpenHaptics driver(settings_);
    EXPECT_TRUE(driver.Configure().ok()) << good;
  }
  const double touch[3] = {3.3, 0.88, 1.02};
  limits(touch);
}

// the process that calls the library looks once more: zero, and the device is closed
TEST_F(OpenHapticsTest, AForceThatNoGateLetsOutIsZeroAndALostDevice) {
  const double nan = std::nan("");
  for (const math::Vec3& bad : {math::Vec3{nan, 0, 0}, math::Vec3{0, 3.4, 0}, math::Vec3{0, 0, 1e300}}) {
    OpenHaptics driver(settings_);
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      return Force(0).x == 1;
    }));
    std::array<ForceSample, 2> samples;
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make(bad));
      return driver.ReadForceSamples(samples) == ReadStatus::kLost;
    }));
    EXPECT_TRUE(WaitFor([&] { return Force(0) == math::Vec3{}; }));
    EXPECT_EQ(Find<int()>("StandInBadForces")(), 0) << "none of it reached the motors";
    // opened again it is another device
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    EXPECT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      return Force(0).x == 1;
    }));
  }
}

TEST_F(OpenHapticsTest, AForceLivesTenMilliseconds) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(Force(0), math::Vec3{}) << "nothing before it is asked for";
  ASSERT_TRUE(WaitFor([&] {
    driver.SendForce(1, haptics::ForceGate::Make({0, 1.5, 0}));
    return Force(1).y == 1.5;
  }));
  EXPECT_EQ(Force(0), math::Vec3{}) << "only the device that is meant";
  // nobody renews it: the library's own thread lets it end, though the other device's goes on
  EXPECT_TRUE(WaitFor([&] {
    driver.SendForce(0, haptics::ForceGate::Make({0, 0.5, 0}));
    return Force(1) == math::Vec3{} && Force(0).y == 0.5;
  }));
  driver.Finalize();
}

TEST_F(OpenHapticsTest, WarmMotorsDropTheForceAndPass) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  for (const unsigned int error : {0x0200u, 0x0201u, 0x0202u, 0x0203u, 0x0204u}) {
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      driver.SendForce(1, haptics::ForceGate::Make({1, 0, 0}));
      return Force(0).x == 1 && Force(1).x == 1;
    }));
    // a machine that is busy may let a force run out by itself: raise until a drop follows the error
    const int before = Find<int()>("StandInDrops")();
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      driver.SendForce(1, haptics::ForceGate::Make({1, 0, 0}));
      Find<void(unsigned int)>("StandInRaise")(error);
      return Find<int()>("StandInDrops")() > before;
    })) << std::hex
        << error;
    EXPECT_NE(driver.ReadForceSamples(samples), ReadStatus::kLost);
  }
  driver.Finalize();
}

TEST_F(OpenHapticsTest, OtherErrorsLoseTheDeviceAtZeroForce) {
  for (const unsigned int error : {0x0302u, 0x0304u, 0x0104u, 0x0300u}) {
    OpenHaptics driver(settings_);
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      return Force(0).x == 1;
    }));
    Find<void(unsigned int)>("StandInRaise")(error);
    std::array<ForceSample, 2> samples;
    ASSERT_TRUE(WaitFor([&] {
      driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
      return driver.ReadForceSamples(samples) == ReadStatus::kLost;
    })) << std::hex
        << error;
    EXPECT_EQ(driver.GetState(), DriverState::kUnconfigured);
    EXPECT_TRUE(driver.NeedsRelease()) << "the reader closes nothing";
    EXPECT_TRUE(WaitFor([&] { return Force(0) == math::Vec3{}; }));
    driver.Release();
    EXPECT_EQ(Find<int()>("StandInDevices")(), 0);
    EXPECT_EQ(Find<int()>("StandInMisuses")(), 0);
    EXPECT_EQ(driver.GetLimits(0).max_force, 0.0) << "of a device that is open";
    // it can be had again
    EXPECT_TRUE(driver.Configure().ok());
    EXPECT_EQ(Find<int()>("StandInDevices")(), 2);
  }
}

TEST_F(OpenHapticsTest, LeavesZeroBehind) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  ASSERT_TRUE(WaitFor([&] {
    driver.SendForce(0, haptics::ForceGate::Make({0, 0, 2}));
    return Force(0).z == 2;
  }));
  driver.SendForce(0, haptics::ForceGate::Make({0, 0, 2}));
  const host::Stopwatch watch;
  ASSERT_TRUE(driver.Deactivate().ok());
  EXPECT_LT(watch.Seconds(), 0.45) << "it waits for the scheduler's word, not for the time that it may take";
  EXPECT_EQ(Force(0), math::Vec3{});
  const int callbacks = Find<int()>("StandInCallbacks")();
  SystemClock().Sleep(0.01);
  EXPECT_EQ(Find<int()>("StandInCallbacks")(), callbacks) << "the scheduler has ended";
}

// what is no rotation stays none, for the guard to see
TEST_F(OpenHapticsTest, ABadTransformIsNoGoodPose) {
  const auto set = Find<void(int)>("StandInTransform");
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  std::array<HandSample, 2> hands;
  const auto turn = [&] { return math::SquaredNorm(samples[0].orientation); };
  // a rotation that is one: 0.6 rad about (2, -1, 2) / 3
  set(6);
  const double half = 0.3, s = std::sin(half) / 3.0;
  EXPECT_TRUE(WaitFor([&] {
    driver.ReadForceSamples(samples);
    const math::Quaternion& q = samples[0].orientation;
    return std::fabs(q.w - std::cos(half)) < 1e-9 && std::fabs(q.x - 2 * s) < 1e-9 &&
           std::fabs(q.y + s) < 1e-9 && std::fabs(q.z - 2 * s) < 1e-9;
  }));
  // one that is nearly one is put right: a matrix of single precision is never exact
  set(11);
  EXPECT_TRUE(WaitFor([&] {
    driver.ReadForceSamples(samples);
    const math::Quaternion& q = samples[0].orientation;
    return std::fabs(q.w - 1.0) < 1e-9 && std::fabs(q.z) < 1e-9;
  }));
  // as far askew as is still put right
  set(12);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(WaitFor([&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
    EXPECT_NEAR(turn(), 1.0, 1e-9);
  }
  for (const int kind : {1, 2, 3, 4, 5, 7, 8, 9, 10}) {
    set(0);
    ASSERT_TRUE(
        WaitFor([&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh && turn() == 1.0; }));
    driver.Read(hands);
    EXPECT_TRUE(hands[0].is_valid) << "the control";
    set(kind);
    EXPECT_TRUE(WaitFor([&] {
      return driver.ReadForceSamples(samples) == ReadStatus::kFresh && turn() == 0.0;
    })) << kind;
    driver.Read(hands);
    EXPECT_FALSE(hands[0].is_valid) << kind;
  }
  set(0);
}

TEST_F(OpenHapticsTest, AMotorThatSaysNothingHidesNoHotOne) {
  const auto set = Find<void(const double*)>("StandInTemperatures");
  const double nan = std::nan("");
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  const double motors[][3] = {{nan, 1.2, 0.1}, {1.2, nan, nan}, {0.1, nan, 1.2}};
  for (const auto& three : motors) {
    set(three);
    EXPECT_TRUE(WaitFor([&] {
      return driver.ReadForceSamples(samples) == ReadStatus::kFresh && samples[0].temperature == 1.2;
    }));
  }
  const double well[] = {0.2, 0.4, 0.1};
  set(well);
}

TEST_F(OpenHapticsTest, SaysWhatIsMissing) {
  settings_.hd_file = "libHD_that_nobody_has.so";
  OpenHaptics without(settings_);
  const base::Status status = without.Configure();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kDeviceUnsupported);
  EXPECT_NE(status.error().message.find("install"), std::string::npos);

  settings_.hd_file = "libm.so.6";
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, ErrorCode::kDeviceUnsupported);

  settings_.hd_file = TROCAR_STAND_IN_HD;
  settings_.names = {"Left", "nobody"};
  const base::Status nobody = OpenHaptics(settings_).Configure();
  EXPECT_EQ(nobody.error().code, ErrorCode::kDeviceLost);
  EXPECT_NE(nobody.error().message.find("a stand-in's error"), std::string::npos);
  EXPECT_EQ(Find<int()>("StandInDevices")(), 0) << "the first is given back";
  for (const std::size_t count : {0u, 3u}) {
    settings_.names.assign(count, "Left");
    EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, ErrorCode::kDeviceSettings) << count;
    EXPECT_EQ(OpenHaptics(settings_).GetChannelCount(), count == 0 ? 1 : 2);
  }
}

// warm motors are no reason to refuse a device, anything else is
TEST_F(SteppedLibrary, OpensAndStartsWithAnErrorThatPasses) {
  for (const unsigned int error : {0x0203u, 0x0304u}) {
    const bool passes = error == 0x0203;
    OpenHaptics driver(settings_);
    Raise(error);
    EXPECT_EQ(driver.Configure().ok(), passes);
    EXPECT_EQ(Find<int()>("StandInDevices")(), passes ? 2 : 0);
    if (!passes) {
      ASSERT_TRUE(driver.Configure().ok());
    }
    Raise(error);
    EXPECT_EQ(driver.Activate().ok(), passes);
    if (passes) Step();
  }
}

// what the watchdog of the library's process goes by
TEST_F(SteppedLibrary, CallsAreCountedAndZeroIsPushedBetweenThem) {
  ForceMailbox mailbox;
  HdDevices devices(mailbox);
  std::vector<ForceLimits> limits;
  ASSERT_TRUE(devices.Open(settings_, limits).ok());
  ASSERT_EQ(limits.size(), 2u);
  mailbox.Clear();
  ASSERT_TRUE(devices.Start().ok());
  EXPECT_FALSE(devices.IsCalled()) << "not yet";
  EXPECT_EQ(devices.CountCalls(), 0u);
  const auto push = [&] {
    for (int i = 0; i < 3; ++i) mailbox.Send(0, haptics::ForceGate::Make({1, 0, 0})), Step();
  };
  push();
  EXPECT_TRUE(devices.IsCalled());
  EXPECT_EQ(devices.CountCalls(), 6u) << "begun and ended";
  EXPECT_EQ(Force(0).x, 1.0);
  devices.PushZero();
  EXPECT_EQ(Force(0), math::Vec3{});
  EXPECT_EQ(devices.CountCalls(), 6u);
  // in the middle of a call it would break the library's frame
  push();
  Fail(StandInFault::kSlowCalls);
  std::thread caller([this] { Step(); });
  while (devices.CountCalls() % 2 == 0) std::this_thread::yield();
  const host::Stopwatch watch;
  devices.PushZero();
  EXPECT_LT(watch.Seconds(), 0.030) << "not one call of the library";
  Fail(StandInFault::kNone);
  caller.join();
  // a device that is lost is not pushed
  mailbox.SetLost();
  push();
  EXPECT_EQ(Force(0), math::Vec3{});
  // nobody calls any more: the end waits half a second for it, and no longer
  const host::Stopwatch end;
  devices.Stop();
  EXPECT_GT(end.Seconds(), 0.4);
  const std::uint64_t calls = devices.CountCalls();
  Step();
  EXPECT_EQ(devices.CountCalls(), calls) << "the library has been told to forget us";
  devices.Close();
  settings_.names = {"Left", "nobody"};
  limits.clear();
  EXPECT_FALSE(devices.Open(settings_, limits).ok());
  EXPECT_TRUE(limits.empty()) << "nothing is open";
  EXPECT_EQ(Find<int()>("StandInDevices")(), 0);
}

TEST_F(SteppedLibrary, StartsAgainAsAnew) {
  ForceMailbox mailbox;
  HdDevices devices(mailbox);
  std::vector<ForceLimits> limits;
  ASSERT_TRUE(devices.Open(settings_, limits).ok());
  for (int i = 0; i < 2; ++i) {
    mailbox.Clear();
    ASSERT_TRUE(devices.Start().ok());
    std::array<ForceSample, 2> samples;
    Step();
    EXPECT_EQ(mailbox.Read(samples), ReadStatus::kFresh);
    EXPECT_EQ(samples[0].sequence, 1u);
    EXPECT_TRUE(devices.IsCalled());
    std::atomic<bool> is_over{false};
    std::thread scheduler([&] {
      while (!is_over) Step(), SystemClock().Sleep(0.001);
    });
    devices.Stop();
    is_over = true;
    scheduler.join();
    EXPECT_FALSE(devices.IsCalled()) << "nobody has to call any more";
  }
}

// a library that says nothing for half a second is a lost device, one that says nothing for less is not
TEST_F(SteppedLibrary, IsLostAfterHalfASecondWithoutAReport) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  Step();
  EXPECT_EQ(driver.ReadForceSamples(samples), ReadStatus::kFresh);
  const host::Stopwatch watch;
  for (;;) {
    const double before = watch.Seconds();
    const ReadStatus status = driver.ReadForceSamples(samples);
    if (status == ReadStatus::kLost) break;
    ASSERT_LT(before, 0.51) << "however late this thread is";
    SystemClock().Sleep(0.002);
  }
  EXPECT_GT(watch.Seconds(), 0.49);
}

TEST(ForceMailbox, TheNewestForceOfEachDeviceLivesTenMilliseconds) {
  using math::Vec3;
  const auto make = [](const Vec3& force) { return haptics::ForceGate::Make(force); };
  ForceMailbox mailbox;
  EXPECT_EQ(mailbox.TakeForces(), ForceMailbox::Forces{});
  mailbox.Clear();
  EXPECT_EQ(mailbox.TakeForces(), ForceMailbox::Forces{});
  // a busy machine may let one run out between the two calls
  const auto sent_and_taken = [&](int channel, const Vec3& force) {
    for (int i = 0; i < 100; ++i) {
      mailbox.Send(channel, make(force));
      const ForceMailbox::Forces taken = mailbox.TakeForces();
      if (taken[static_cast<std::size_t>(channel)] == force) return true;
    }
    return false;
  };
  EXPECT_TRUE(sent_and_taken(1, {0, 1, 0}));
  EXPECT_TRUE(sent_and_taken(0, {2, 0, 0}));
  mailbox.Send(-1, make({7, 7, 7}));
  mailbox.Send(2, make({7, 7, 7}));
  for (const Vec3& force : mailbox.TakeForces()) EXPECT_NE(force.z, 7.0) << "of no device";
  SystemClock().Sleep(0.011);
  EXPECT_EQ(mailbox.TakeForces(), ForceMailbox::Forces{});
  EXPECT_TRUE(sent_and_taken(0, {2, 0, 0}));
  mailbox.Clear();
  EXPECT_EQ(mailbox.TakeForces(), ForceMailbox::Forces{}) << "not one of an earlier life";
  mailbox.Send(1, make({0, 1, 0}));
  EXPECT_EQ(mailbox.TakeForces()[0], Vec3{}) << "nor after the next";
}

TEST(ForceMailbox, ALostDeviceIsLostForBothReadersUntilItIsCleared) {
  ForceMailbox mailbox;
  ForceMailbox::Reports reports;
  for (ForceSample& report : reports)
    report.is_calibrated = true, report.status = ForceDeviceStatus::kOk, report.sequence = 1;
  mailbox.Clear();
  std::array<ForceSample, 2> samples;
  std::array<HandSample, 2> hands;
  const math::Vec3 trocar{0, 0, 0.1};
  EXPECT_EQ(mailbox.Read(hands, trocar), ReadStatus::kUnchanged);
  mailbox.Report(reports);
  EXPECT_EQ(mailbox.Read(hands, trocar), ReadStatus::kFresh);
  EXPECT_TRUE(hands[0].is_valid && hands[1].is_valid);
  EXPECT_EQ(mailbox.Read(hands, trocar), ReadStatus::kUnchanged);
  EXPECT_EQ(mailbox.Read(samples), ReadStatus::kUnchanged) << "one reader has had it";
  EXPECT_FALSE(mailbox.IsLost());
  mailbox.SetLost();
  EXPECT_TRUE(mailbox.IsLost());
  EXPECT_EQ(mailbox.Read(samples), ReadStatus::kLost);
  EXPECT_EQ(mailbox.Read(hands, trocar), ReadStatus::kLost);
  mailbox.Clear();
  EXPECT_EQ(mailbox.Read(samples), ReadStatus::kUnchanged);
}

TEST_F(OpenHapticsTest, IsOnlyOneAtATime) {
  OpenHaptics first(settings_), second(settings_);
  ASSERT_TRUE(first.Configure().ok());
  EXPECT_EQ(second.Configure().error().code, ErrorCode::kDeviceBusy);
  ASSERT_TRUE(first.Cleanup().ok());
  EXPECT_TRUE(second.Configure().ok());
}

TEST(ForceDeviceSpec, MakesTheDeviceThatIsNamed) {
  const auto channels = [](const char* text) {
    const auto made = MakeForceDriver(text);
    return made.ok() ? (*made)->GetName() + std::to_string((*made)->GetChannelCount())
                     : made.error().Text().substr(0, 9);
  };
  EXPECT_EQ(channels("openhaptics"), "openhaptics1");
  EXPECT_EQ(channels("openhaptics:Left,Right"), "openhaptics2");
  EXPECT_EQ(channels("haply"), "haply1");
  EXPECT_EQ(channels("haply:2:4000"), "haply2");
  for (const char* bad : {"", "toaster", "haply:two", "haply:0", "haply:2:99999"})
    EXPECT_EQ(channels(bad), "E-DEV-004") << bad;
}

}  // namespace
}  // namespace trocar::device
