// SPDX-License-Identifier: Apache-2.0
/// \file device_hands.h  Effect of a device's hands and buttons on the input of a tick.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/device/hand_buttons.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/scene/scene.h"

namespace trocar::session {

using DeviceSamples = std::array<device::HandSample, device::kChannelCount>;
using DeviceActs = std::array<device::HandActs, instrument::kHandCount>;
static_assert(static_cast<std::size_t>(instrument::kHandCount) == device::kButtonHands);

/// Presses the pedals that a device holds down. Adds to the input; lifts none that somebody else holds.
void PressPedals(const DeviceActs& acts, scene::Input& input) noexcept;

/// Command that the next press of the assistant's button gives: retract, relax, release, wait, and again.
scene::AssistantCommand NextCommand(scene::AssistantCommand now) noexcept;

/// Hands and buttons of one device, with what its buttons leave behind: the tool in each hand, a frozen hand, and the way
/// between hand and tool after a clutch.
/// \note Real-time safe: no allocation, lock or throw.
class DeviceHands {
 public:
  explicit DeviceHands(const scene::Scene& scene) noexcept;

  /// The first tick again, or another device: nothing is frozen, tools stand where the hands are.
  void Restart() noexcept;

  /// Acts on every press since the last look: tool, assistant, freeze. Each press counts once.
  /// \param[in,out] input  where the tool and the assistant stand
  void Step(const DeviceActs& acts, scene::Input& input) noexcept;
  /// Forgets the presses since the last look: while nothing runs, buttons do nothing.
  void Ignore(const DeviceActs& acts) noexcept { seen_ = acts; }
  /// Takes every hand that the device sees; the others stay as they are. A hand's numbers go through the same limits of joints
  /// and speed as any other input. A hand that is frozen or whose clutch is held stands still, jaws included, and goes on from
  /// there.
  void Move(const DeviceSamples& samples, const DeviceActs& acts, scene::Input& input) noexcept;

  /// A clutch or freeze that is not a button of the device: a key or a foot pedal.
  void SetClutch(instrument::Hand hand, bool is_held) noexcept { hands_[hand].has_other_clutch = is_held; }
  void ToggleFreeze(instrument::Hand hand) noexcept { hands_[hand].is_frozen = !hands_[hand].is_frozen; }
  bool IsFrozen(instrument::Hand hand) const noexcept { return hands_[hand].is_frozen; }

 private:
  struct HeldHand {
    bool is_frozen = false, has_other_clutch = false;
    bool is_still = false;
    instrument::TrocarJoints joints;  // where the tool stands or stood last
    instrument::TrocarJoints offset;  // of the tool from the hand; jaw 0
    bool has_joints = false;
  };

  std::array<std::size_t, instrument::kHandCount> tray_sizes_{};
  DeviceActs seen_;
  std::array<HeldHand, instrument::kHandCount> hands_;
};

}  // namespace trocar::session
