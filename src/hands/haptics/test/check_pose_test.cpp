// SPDX-License-Identifier: Apache-2.0
// Whose device is whose: each condition of the check pose from both sides.
#include "trocar/haptics/check_pose.h"

#include <gtest/gtest.h>

namespace trocar::haptics {
namespace {

class Poses {
 public:
  Poses() : check(MakeSettings()) {
    for (GuardedDevice& device : devices)
      device.has_pose = device.is_calibrated = true, device.fault = Fault::kNone,
      device.position = {0.2, 0, 0};
  }
  static CheckPoseSettings MakeSettings() {
    CheckPoseSettings settings;
    settings.p_device[0] = {0, -0.05, 0.02};
    settings.p_device[1] = {0, 0.05, 0.02};
    return settings;
  }
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) check.Step(devices);
  }
  /// Brings a device near its place and holds its button.
  void Hold(std::size_t device, int ticks, const math::Vec3& offset = {}) {
    devices[device].position = MakeSettings().p_device[device] + offset;
    devices[device].buttons = 1;
    Run(ticks);
  }
  void LetGo(std::size_t device) {
    devices[device].buttons = 0;
    Run(1);
  }
  void Confirm() {
    check.Begin();
    Run(1);
    Hold(0, 200), LetGo(0);
    Hold(1, 200), LetGo(1);
  }
  CheckPoseState State() const { return check.GetState(); }

  CheckPose check;
  std::array<GuardedDevice, 2> devices;
};

TEST(CheckPose, AsksForOneAfterTheOtherForTwoHundredTicks) {
  Poses poses;
  poses.Run(10);
  EXPECT_EQ(poses.State(), CheckPoseState::kUnconfirmed) << "nobody has begun";
  poses.check.Begin();
  EXPECT_EQ(poses.State(), CheckPoseState::kAsking);
  EXPECT_EQ(poses.check.GetAsked(), 0u);
  poses.Run(1);
  poses.Hold(0, 199);
  EXPECT_EQ(poses.check.GetAsked(), 0u);
  poses.Run(1);
  EXPECT_EQ(poses.check.GetAsked(), 1u);
  EXPECT_FALSE(poses.check.IsConfirmed());
  // the first's button is still held: that is no answer of another device
  poses.Run(50);
  EXPECT_EQ(poses.State(), CheckPoseState::kAsking);
  poses.LetGo(0);
  poses.Hold(1, 199);
  EXPECT_FALSE(poses.check.IsConfirmed());
  poses.Run(1);
  EXPECT_TRUE(poses.check.IsConfirmed());
  poses.Run(1000);
  EXPECT_TRUE(poses.check.IsConfirmed());
  poses.check.Begin();
  EXPECT_EQ(poses.State(), CheckPoseState::kAsking) << "begun anew";
  EXPECT_EQ(poses.check.GetAsked(), 0u);
}

TEST(CheckPose, DoesNotSurviveALoss) {
  for (const std::size_t lost : {0u, 1u}) {
    Poses poses;
    poses.Confirm();
    ASSERT_TRUE(poses.check.IsConfirmed());
    poses.devices[lost].fault = Fault::kSilent;
    poses.Run(10);
    EXPECT_TRUE(poses.check.IsConfirmed()) << "silence is no loss";
    poses.devices[lost].fault = Fault::kDeviceLost;
    poses.Run(1);
    EXPECT_EQ(poses.State(), CheckPoseState::kUnconfirmed);
    poses.devices[lost].fault = Fault::kNone;
    poses.Run(1000);
    EXPECT_EQ(poses.State(), CheckPoseState::kUnconfirmed) << "what comes back may be another device";
    // while it asks, too
    poses.check.Begin();
    poses.Run(1);
    poses.devices[lost].fault = Fault::kDeviceLost;
    poses.Run(1);
    EXPECT_EQ(poses.State(), CheckPoseState::kUnconfirmed);
  }
}

TEST(CheckPose, TheOtherDeviceStaysStillWithItsButtonUp) {
  for (const double moved : {0.0049, 0.005, 0.0051}) {
    Poses poses;
    poses.check.Begin();
    poses.Run(1);
    poses.Hold(0, 100);
    poses.devices[1].position.y += moved;
    poses.Run(1);
    EXPECT_EQ(poses.State(), moved > 0.005 ? CheckPoseState::kWrongDevice : CheckPoseState::kAsking) << moved;
  }
  Poses pressed;
  pressed.check.Begin();
  pressed.Run(1);
  pressed.devices[1].buttons = 2;
  pressed.Run(10);
  EXPECT_EQ(pressed.State(), CheckPoseState::kAsking) << "only the first button answers";
  pressed.devices[1].buttons = 1;
  pressed.Run(1);
  EXPECT_EQ(pressed.State(), CheckPoseState::kWrongDevice);
  pressed.devices[1].buttons = 0;
  pressed.Hold(0, 1000);
  EXPECT_EQ(pressed.State(), CheckPoseState::kWrongDevice) << "until somebody begins again";
  // the second turn is judged from where the devices are then, not from the beginning
  Poses second;
  second.check.Begin();
  second.Run(1);
  second.Hold(0, 200), second.LetGo(0);
  second.Hold(1, 100);
  EXPECT_EQ(second.State(), CheckPoseState::kAsking);
  second.devices[0].position.x += 0.0051;
  second.Run(1);
  EXPECT_EQ(second.State(), CheckPoseState::kWrongDevice);
}

TEST(CheckPose, ThePlaceIsTwentyMillimetresWide) {
  for (const double offset : {0.0199, 0.020, 0.0201}) {
    Poses poses;
    poses.check.Begin();
    poses.Run(1);
    poses.Hold(0, 300, {offset, 0, 0});
    EXPECT_EQ(poses.check.GetAsked(), offset <= 0.020 ? 1u : 0u) << offset;
  }
}

TEST(CheckPose, EveryTickHasToHold) {
  const auto hold_all_but_one = [](const auto& spoil) {
    Poses poses;
    poses.check.Begin();
    poses.Run(1);
    poses.Hold(0, 150);
    const GuardedDevice good = poses.devices[0];
    spoil(poses.devices[0]);
    poses.Run(1);
    poses.devices[0] = good;
    poses.Run(199);
    EXPECT_EQ(poses.check.GetAsked(), 0u) << "counted on";
    poses.Run(1);
    EXPECT_EQ(poses.check.GetAsked(), 1u);
  };
  hold_all_but_one([](GuardedDevice& device) { device.buttons = 0; });
  hold_all_but_one([](GuardedDevice& device) { device.is_calibrated = false; });
  hold_all_but_one([](GuardedDevice& device) { device.fault = Fault::kBadSamples; });
  hold_all_but_one([](GuardedDevice& device) { device.position.z += 0.05; });
}

TEST(CheckPose, BeginsOnceAllButtonsAreUp) {
  Poses poses;
  poses.devices[1].buttons = 1;
  poses.check.Begin();
  poses.Hold(0, 300);
  EXPECT_EQ(poses.State(), CheckPoseState::kAsking);
  EXPECT_EQ(poses.check.GetAsked(), 0u);
  poses.devices[0].buttons = poses.devices[1].buttons = 0;
  poses.Run(1);
  poses.Hold(0, 200);
  EXPECT_EQ(poses.check.GetAsked(), 1u);
  // begun anew it counts from none, and from where the devices are now
  poses.check.Begin();
  poses.LetGo(0);
  poses.Hold(0, 150);
  poses.check.Begin();
  poses.LetGo(0);
  poses.devices[1].position.y += 0.1;
  poses.check.Begin();
  poses.Run(1);
  poses.Hold(0, 199);
  EXPECT_EQ(poses.State(), CheckPoseState::kAsking);
  EXPECT_EQ(poses.check.GetAsked(), 0u);
  poses.Run(1);
  EXPECT_EQ(poses.check.GetAsked(), 1u);
}

}  // namespace
}  // namespace trocar::haptics
