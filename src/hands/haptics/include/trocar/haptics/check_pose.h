// SPDX-License-Identifier: Apache-2.0
/// \file check_pose.h  Is the left device the left one, and calibrated? A person says so with the devices themselves.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "trocar/haptics/device_guard.h"

namespace trocar::haptics {

inline constexpr std::size_t kMaxChannels = 4;

struct CheckPoseSettings {
  std::array<math::Vec3, kMaxChannels> p_device;  ///< where each device has to be brought, its own frame [m]
  double radius = 0.020;                          ///< about that place [m]
  double still_radius = 0.005;                    ///< the others may move by this meanwhile [m]
  int ticks = 200;                                ///< for which the button must be held there
};

enum class CheckPoseState : std::uint8_t {
  kUnconfirmed,  ///< not begun, or lapsed with a lost device
  kAsking,       ///< waits for the channel that is asked for
  kWrongDevice,  ///< another device answered: two are swapped (D13); begin again
  kConfirmed
};

/// Asks for each channel in turn: bring this device to its place and hold its first button, the others stay still.
class CheckPose {
 public:
  explicit CheckPose(const CheckPoseSettings& settings) noexcept : settings_(settings) {}

  /// Asks for channel 0; forgets what was confirmed.
  void Begin() noexcept;
  /// \param devices  one a channel, at most kMaxChannels
  /// \note Real-time safe.
  void Step(std::span<const GuardedDevice> devices) noexcept;

  CheckPoseState GetState() const noexcept { return state_; }
  /// Channel that is asked for; meaningful while kAsking.
  std::size_t GetAsked() const noexcept { return asked_; }
  bool IsConfirmed() const noexcept { return state_ == CheckPoseState::kConfirmed; }

 private:
  CheckPoseSettings settings_;
  CheckPoseState state_ = CheckPoseState::kUnconfirmed;
  std::size_t asked_ = 0;
  int held_ticks_ = 0;
  bool has_start_ = false;
  std::array<math::Vec3, kMaxChannels> start_;  // where each was when this one was asked for
};

}  // namespace trocar::haptics
