// SPDX-License-Identifier: Apache-2.0
/// \file haptic_bench.h  Haptic ticks on a bench: a simulated device for two hands that press a sheet of tissue, and a
/// clock that the test moves.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "haptic_tick.h"
#include "pressed_sheet.h"
#include "trocar/device/simulated_force_device.h"

namespace trocar::session {

class HapticBench {
 public:
  /// \param rings  of the segments
  explicit HapticBench(int rings = tissue::PatchCutter::kMaxRings) {
    sheet.Solve({0, 0, -0.003});
    patch = sheet.Cut(rings);
    device::SimulatedForceSettings simulated;
    simulated.channel_count = 2;
    simulated.path = [this](int, double) { return hand; };  // both hands alike
    device = std::make_unique<device::SimulatedForceDevice>(simulated);
    EXPECT_TRUE(device->Configure().ok() && device->Activate().ok());
    for (const instrument::Hand side : {instrument::kLeft, instrument::kRight}) {
      HapticHand made;
      made.hand = side;
      made.p_world_port = {0, 0, 0.15};
      settings.hands.push_back(made);
    }
    tick = std::make_unique<HapticTick>(*device, settings, link);
    input.is_supervised = true;
    input.now = 10;
  }

  void Step() {
    input.now += 0.001;
    if (count++ % 8 == 0) {
      for (const instrument::Hand side : {instrument::kLeft, instrument::kRight}) {
        link.patches[side].Back() = is_touching ? patch : Untouched();
        link.patches[side].Publish();
      }
    }
    tick->Run(input);
    input.wants_arm = input.wants_stop = input.wants_check_pose = false;
  }
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) Step();
  }
  void SetButtons(std::uint32_t left, std::uint32_t right) {
    device->SetButtons(0, left);
    device->SetButtons(1, right);
  }
  /// Answers the check pose with one button after the other, then holds both.
  void Confirm() {
    input.wants_check_pose = true;
    SetButtons(0, 0), Run(5);
    SetButtons(1, 0), Run(210);
    SetButtons(0, 0), Run(5);
    SetButtons(0, 1), Run(210);
    SetButtons(1, 1), Run(5);
  }
  void Arm() {
    Confirm();
    input.wants_arm = true;
    Run(2100);
  }
  /// Armed, with both tools in tissue.
  void ArmAndTouch() {
    Arm();
    is_touching = true;
    hand = {0, 0, -0.006};
    Run(100);
  }
  const HapticHandStatus& Right() const { return tick->GetStatus().hands[instrument::kRight]; }

  static tissue::LocalPatch Untouched() {
    tissue::LocalPatch none;
    none.is_healthy = true;
    return none;
  }

  haptics::PressedSheet sheet;
  tissue::LocalPatch patch;
  bool is_touching = false;
  math::Vec3 hand;  // of both channels, device frame = world frame [m]
  std::unique_ptr<device::SimulatedForceDevice> device;
  HapticLoopSettings settings;
  HapticLink link;
  std::unique_ptr<HapticTick> tick;
  HapticTickInput input;
  long count = 0;
};

}  // namespace trocar::session
