// SPDX-License-Identifier: Apache-2.0
/// \file haptic_bench.h  Haptic ticks on a bench: a simulated device for two hands that press a sheet of tissue, and a
/// clock that the test moves.
#pragma once

#include <memory>

#include "haptic_tick.h"
#include "pressed_sheet.h"
#include "trocar/device/simulated_force_device.h"

namespace trocar::session {

class HapticBench {
 public:
  /// \param rings  of the segments
  explicit HapticBench(int rings = haptics::PatchCutter::kMaxRings) {
    sheet.Solve({0, 0, -0.003});
    patch = sheet.Cut(rings);
    device::SimulatedForceSettings simulated;
    simulated.channel_count = 2;
    simulated.path = [this](int, double) { return hand; };
    device = std::make_unique<device::SimulatedForceDevice>(simulated);
    EXPECT_TRUE(device->Configure().ok() && device->Activate().ok());
    for (const Hand side : {kLeft, kRight}) {
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
      for (const Hand side : {kLeft, kRight}) {
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
  /// Both hands answer the check pose: the simulated device moves both at once, so one after the other by buttons.
  void Confirm();
  void Arm() {
    input.wants_arm = true;
    Run(2100);
  }
  const HapticHandStatus& Right() const { return tick->GetStatus().hands[kRight]; }

  static haptics::LocalPatch Untouched() {
    haptics::LocalPatch none;
    none.is_healthy = true;
    return none;
  }

  haptics::PressedSheet sheet;
  haptics::LocalPatch patch;
  bool is_touching = false;
  Vec3 hand;  // of both channels, device frame = world frame [m]
  std::unique_ptr<device::SimulatedForceDevice> device;
  HapticLoopSettings settings;
  HapticLink link;
  std::unique_ptr<HapticTick> tick;
  HapticTickInput input;
  long count = 0;
};

}  // namespace trocar::session
