// SPDX-License-Identifier: Apache-2.0
/// \file haptic_channel.h  One device and one tool: from a report to a gated force, without a clock or a thread.
#pragma once

#include "trocar/haptics/coupling.h"
#include "trocar/haptics/device_guard.h"
#include "trocar/haptics/force_gate.h"
#include "trocar/haptics/local_model.h"

namespace trocar::haptics {

struct ChannelSettings {
  DeviceMap map;
  device::ForceLimits limits;
  DeviceGuardSettings guard;
  double tick = 0.001;         ///< [s]
  double max_patch_age = 0.1;  ///< older tissue is no tissue: the simulation stands [s]
  std::uint32_t dead_man_mask =
      1;  ///< buttons of the device of which one must be held; 0: only a pedal counts
};

/// Conditions of all channels of a loop in one tick.
struct ChannelConditions {
  bool is_supervised = false;
  bool is_pose_confirmed = false;
  bool is_pedal_held = false;          ///< a safety switch that is not on the device
  bool is_supervisor_tripped = false;  ///< the supervisor had to send zero since the last tick (D10)
};

struct ChannelOutput {
  GateOutput gate;
  LocalAnswer local;      ///< world frame
  bool has_pose = false;  ///< `local` means something
};

class HapticChannel {
 public:
  explicit HapticChannel(const ChannelSettings& settings);

  void RequestArm() noexcept { gate_.RequestArm(); }
  void Stop() noexcept { gate_.Stop(); }

  /// Newest tissue.
  /// \param now  [s]
  /// \note Real-time safe.
  void TakePatch(const tissue::LocalPatch& patch, double now) noexcept;

  /// First half of a tick: what of a report is believed.
  const GuardedDevice& Read(const device::ForceSample& sample, double now) noexcept;
  /// Point of the world where the device is; meaningful with a pose [m].
  math::Vec3 CalcHand() const noexcept { return ToWorld(settings_.map, device_.position); }

  /// Second half: what the hand feels.
  ///
  /// \param X_world_hand  CalcHand() and the direction that the shaft has there
  /// \note Real-time safe: no allocation, lock or throw.
  ChannelOutput Act(const math::Pose& X_world_hand, const LoopTiming& timing,
                    const ChannelConditions& conditions, double now) noexcept;

  const GuardedDevice& GetDevice() const noexcept { return device_; }
  const DeviceGuardCounts& GetCounts() const noexcept { return guard_.GetCounts(); }
  const ChannelSettings& GetSettings() const noexcept { return settings_; }

 private:
  ChannelSettings settings_;
  DeviceGuard guard_;
  LocalModel model_;
  ForceGate gate_;
  GuardedDevice device_;
  double patch_time_ = 0;  // [s]
  bool is_patch_healthy_ = false;
};

}  // namespace trocar::haptics
