// SPDX-License-Identifier: Apache-2.0
/// \file haptic_tick.h  One tick of the haptic loop, without its thread and clock.
#pragma once

#include <vector>

#include "trocar/session/haptic_loop.h"

namespace trocar::session {

/// Input of a tick from the loop.
struct HapticTickInput {
  double now = 0;       ///< [s]
  double lateness = 0;  ///< of this tick [s]
  /// asked for by a person since the last tick
  bool wants_arm = false, wants_stop = false, wants_check_pose = false;
  bool is_pedal_held = false;
  bool is_supervised = false, is_supervisor_tripped = false;
  bool is_device_away = false;  ///< the driver is opened again elsewhere and must not be touched
};

class HapticTick {
 public:
  /// \param driver  active
  HapticTick(device::ForceDriver& driver, const HapticLoopSettings& settings, HapticLink& link);

  /// Reads, judges, solves, gates, sends, publishes.
  /// \note Real-time safe: no allocation, lock, wait or throw, if the driver keeps its promise.
  void Run(const HapticTickInput& input) noexcept;

  /// Of the last tick; the loop adds its times.
  const HapticStatus& GetStatus() const noexcept { return status_; }

 private:
  math::Pose FindHandPose(std::size_t channel) const noexcept;
  void Publish(std::size_t channel, const haptics::ChannelOutput& output) noexcept;

  device::ForceDriver& driver_;
  HapticLoopSettings settings_;
  HapticLink& link_;
  std::vector<haptics::HapticChannel> channels_;
  std::vector<device::ForceSample> samples_;
  std::vector<haptics::GuardedDevice> devices_;
  haptics::CheckPose check_pose_;
  haptics::LoopGuard loop_guard_;
  device::HandButtons buttons_;
  HapticHands hands_;
  HapticStatus status_;
};

}  // namespace trocar::session
