// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/device_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <limits>
#include <thread>

#include "trocar/core/clock.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/emulator.h"
#include "trocar/device/polhemus_tracker.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::session {
namespace {

using device::kLeftHand;
using Phase = DeviceReport::Phase;

TEST(ApplyHands, TakesOnlyHandsThatAreSeenAndFinite) {
  std::array<device::HandSample, device::kChannelCount> samples;
  samples[0] = {0.1, 0.2, 0.3, 0.15, 0.5, 0, true};
  samples[1] = {0.4, 0.4, 0.4, 0.4, 0.4, 0, false};
  samples[2] = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 0, 0, true};
  Input input, before;
  ApplyHands(samples, input);
  EXPECT_EQ(input.hands[0], (instrument::TrocarJoints{0.1, 0.2, 0.3, 0.15, 0.5}));
  EXPECT_EQ(input.hands[1], before.hands[1]);
  EXPECT_EQ(input.laparoscope, before.laparoscope);
}

// the device's own way from joints to a pose and back must be the instrument's
TEST(ApplyHands, ASensorsPoseGivesTheToolPoseOfTheKinematics) {
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
      for (const core::Stopwatch watch; is_running_; device::SystemClock().Sleep(0.002))
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
