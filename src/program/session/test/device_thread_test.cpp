// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/device_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <limits>
#include <thread>

#include "trocar/device/device_spec.h"
#include "trocar/device/emulator.h"
#include "trocar/device/polhemus_tracker.h"
#include "trocar/host/clock.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::session {

using instrument::kRight;
namespace {

using device::kLeftHand;
using Phase = DeviceReport::Phase;

TEST(DeviceHands, TakesOnlyHandsThatAreSeenAndFinite) {
  std::array<device::HandSample, device::kChannelCount> samples;
  samples[0] = {0.1, 0.2, 0.3, 0.15, 0.5, 0, true};
  samples[1] = {0.4, 0.4, 0.4, 0.4, 0.4, 0, false};
  samples[2] = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 0, 0, true};
  scene::Input input, before;
  DeviceHands(scene::Scene()).Move(samples, {}, input);
  EXPECT_EQ(input.hands[0], (instrument::TrocarJoints{0.1, 0.2, 0.3, 0.15, 0.5}));
  EXPECT_EQ(input.hands[1], before.hands[1]);
  EXPECT_EQ(input.laparoscope, before.laparoscope);
}

// the device's own way from joints to a pose and back must be the instrument's
TEST(DeviceHands, ASensorsPoseGivesTheToolPoseOfTheKinematics) {
  const auto settings = *device::MakeHandsSettings(device::DefaultTracker());
  const device::HandCalibration& hand = settings.calibrations[kLeftHand];
  for (int i = 0; i < 50; ++i) {
    const device::HandSample joints = device::CalcHandMotion(0.1 * i)[kLeftHand];
    const math::Pose X_source_sensor = device::CalcSensorPose(hand, settings.R_world_source, joints);
    const math::Vec3 p_world_trocar = math::Rotate(settings.R_world_source, hand.p_source_trocar);
    const math::Pose X_world_tool = instrument::CalcToolPose(
        p_world_trocar, {joints.pan, joints.tilt, joints.spin, joints.depth, joints.jaw});
    const math::Vec3 p_world_tip = math::Rotate(settings.R_world_source, X_source_sensor * hand.p_sensor_tip);
    EXPECT_LT(math::Distance(p_world_tip, X_world_tool.translation), 1e-12);
    const math::Vec3 up = math::Rotate(settings.R_world_source * X_source_sensor.rotation, hand.up_sensor);
    EXPECT_LT(math::Distance(up, math::Rotate(X_world_tool.rotation, {0, 1, 0})), 1e-12);
  }
}

/// An emulated LIBERTY in real time beside the driver's thread; waits are for events.
class DeviceThreadTest : public testing::Test {
 protected:
  void Plug() {
    device::PolhemusEmulation emulation;
    emulation.format = device::PolhemusFormat::kLiberty;
    emulation.motion =
        device::MoveHands(*device::MakeHandsSettings(device::DefaultTracker()), device::CalcHandMotion);
    host_ = *device::EmulatorHost::MakeSerial(device::MakePolhemusEmulator(emulation));
    path_ = host_->Address();
    is_running_ = true;
    emulator_ = std::thread([this] {
      for (const host::Stopwatch watch; is_running_; device::SystemClock().Sleep(0.002))
        host_->Step(watch.Seconds());
    });
  }
  void Unplug() {
    is_running_ = false;
    if (emulator_.joinable()) emulator_.join();
    host_.reset();
  }
  void TearDown() override { Unplug(); }
  static bool WaitFor(DeviceThread& thread, const std::function<bool(const DeviceReport&)>& is_reached) {
    for (int i = 0; i < 5000; ++i) {
      if (is_reached(thread.Latest())) return true;
      device::SystemClock().Sleep(0.002);
    }
    return false;
  }
  std::unique_ptr<device::Driver> MakeTracker() {
    device::PolhemusSettings settings;
    settings.format = device::PolhemusFormat::kLiberty;
    settings.hands = *device::MakeHandsSettings(device::DefaultTracker());
    // a line that comes back may have another name, as with USB
    return std::make_unique<device::PolhemusTracker>(
        settings, [this] { return device::OpenSerialPort(path_, 115200); }, device::SystemClock());
  }

  std::unique_ptr<device::EmulatorHost> host_;
  std::string path_;
  std::atomic<bool> is_running_{false};
  std::thread emulator_;
};

// faults D1
TEST_F(DeviceThreadTest, ConnectsLosesAndFindsADeviceAgain) {
  Plug();
  DeviceThread thread(MakeTracker());
  ASSERT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.samples[kLeftHand].is_valid; }));
  EXPECT_EQ(thread.Latest().message, "liberty is connected");
  Unplug();
  ASSERT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.phase == Phase::kLost; }));
  EXPECT_FALSE(thread.Latest().samples[kLeftHand].is_valid);
  EXPECT_EQ(thread.Latest().losses, 1u);
  EXPECT_EQ(thread.Latest().message.substr(0, 9), "E-DEV-001");
  Plug();
  ASSERT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.phase == Phase::kRunning; }));
  EXPECT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.samples[kLeftHand].is_valid; }));
}

/// A device whose buttons and whose plug are the test's.
class FakePedals : public device::Driver {
 public:
  explicit FakePedals(std::atomic<std::uint32_t>& buttons, std::atomic<bool>& is_plugged)
      : Driver("pedals", device::kChannelCount), buttons_(buttons), is_plugged_(is_plugged) {}

 private:
  base::Status DoConfigure() override {
    if (is_plugged_) return {};
    return base::Error{base::ErrorCode::kDeviceLost, "not plugged in"};
  }
  base::Status DoActivate() override { return {}; }
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  device::ReadStatus DoRead(std::span<device::HandSample> samples) noexcept override {
    if (!is_plugged_) return device::ReadStatus::kLost;
    samples[kRight].is_valid = true;
    samples[kRight].buttons = buttons_;
    return device::ReadStatus::kUnchanged;  // nothing but the button's time passes
  }
  std::atomic<std::uint32_t>& buttons_;
  std::atomic<bool>& is_plugged_;
};

// faults D1: and its control, a pedal of a device that is not lost stays down
TEST_F(DeviceThreadTest, ALostDeviceLetsGoOfEveryPedalAtOnce) {
  std::atomic<std::uint32_t> buttons{0};
  std::atomic<bool> is_plugged{true};
  device::ButtonMap map = device::DefaultButtons();
  map[kRight][2] = device::HandAct::kRinse;
  DeviceThread thread(std::make_unique<FakePedals>(buttons, is_plugged), map);
  const auto is_held = [](const DeviceReport& report, device::HandAct act) {
    return report.acts[kRight].IsHeld(act);
  };
  const auto are_down = [&](const DeviceReport& report) {
    return is_held(report, device::HandAct::kCut) && is_held(report, device::HandAct::kCoagulate) &&
           is_held(report, device::HandAct::kRinse);
  };
  ASSERT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.phase == Phase::kRunning; }));
  device::SystemClock().Sleep(0.02);  // it has to be seen up first
  buttons = 7;
  ASSERT_TRUE(WaitFor(thread, are_down));
  device::SystemClock().Sleep(0.1);
  ASSERT_TRUE(are_down(thread.Latest())) << "the control";
  is_plugged = false;
  ASSERT_TRUE(WaitFor(thread, [&](const DeviceReport& report) { return report.phase == Phase::kLost; }));
  EXPECT_EQ(thread.Latest().acts[kRight].is_held, device::HandActs{}.is_held);
  is_plugged = true;  // with the foot still on it
  ASSERT_TRUE(WaitFor(thread, [](const DeviceReport& report) { return report.phase == Phase::kRunning; }));
  device::SystemClock().Sleep(0.1);
  EXPECT_EQ(thread.Latest().acts[kRight].is_held, device::HandActs{}.is_held);
  EXPECT_EQ(thread.Latest().acts[kRight].CountPresses(device::HandAct::kCut), 1u);
  buttons = 0;
  device::SystemClock().Sleep(0.02);
  buttons = 7;
  EXPECT_TRUE(WaitFor(thread, are_down));
}

TEST_F(DeviceThreadTest, SaysWhyADeviceIsNotThere) {
  path_ = "/dev/no_such_line";
  DeviceThread thread(MakeTracker());
  ASSERT_TRUE(
      WaitFor(thread, [](const DeviceReport& report) { return report.message.starts_with("E-DEV-001"); }));
  EXPECT_EQ(thread.Latest().phase, Phase::kConnecting);
  EXPECT_EQ(thread.Latest().losses, 0u);
}

}  // namespace
}  // namespace trocar::session
