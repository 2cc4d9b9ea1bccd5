// SPDX-License-Identifier: Apache-2.0
/// \file device_guard.h  Guards of a haptic device: which of its reports are believed, and how late the loop that reads them is.
#pragma once

#include <cstdint>

#include "trocar/device/force_driver.h"
#include "trocar/haptics/fault.h"

namespace trocar::haptics {

struct DeviceGuardSettings {
  double stale_age = 0.010;     ///< from which silence counts: the pose is held and the force fades [s] (D2)
  double silent_age = 0.018;    ///< at which the force is zero: 20 ms less a tick and its lateness [s]
  double max_speed = 2.0;       ///< faster is a jump [m/s] (D5)
  double max_turn_rate = 30.0;  ///< [rad/s]
  double max_reach = 1.0;       ///< no device's workspace is larger, from its origin [m]
  /// Bad reports and jumps among the last kWindow at which a device is not believed any more, in a row or with good ones
  /// between them (D4, D5); so many jumps in a row are where the device now is.
  int max_refused = 3;
  double velocity_time = 0.003;  ///< time constant of the velocity that is derived from positions [s]
};

/// State of a device that is believed in one tick.
struct GuardedDevice {
  math::Vec3 position;           ///< the last good one [m], device frame
  math::Vec3 velocity;           ///< derived from good positions [m/s]
  math::Quaternion orientation;  ///< unit
  std::uint32_t buttons = 0;     ///< none while silent
  double jaw = 0;                ///< [rad]; NaN where the device has none
  double temperature = 0;        ///< [-]; NaN where unknown
  bool is_warm = false;
  bool is_calibrated = false;
  bool has_pose = false;  ///< false until the first good report
  double scale = 0;       ///< of the force: 1, falling to 0 while the device is silent [-]
  Fault fault = Fault::kDeviceLost;
};

struct DeviceGuardCounts {
  std::uint64_t good = 0, bad = 0, jumps = 0, silences = 0;
};

class DeviceGuard {
 public:
  /// Reports that are remembered as good or bad.
  static constexpr int kWindow = 32;

  explicit DeviceGuard(const DeviceGuardSettings& settings = {}) noexcept : settings_(settings) {}

  /// Judges the newest report.
  ///
  /// \param now  [s], any origin, never falling
  /// \note Real-time safe: no allocation, lock or throw.
  GuardedDevice Step(const device::ForceSample& sample, double now) noexcept;

  const DeviceGuardCounts& GetCounts() const noexcept { return counts_; }

 private:
  void Take(const device::ForceSample& sample, double now) noexcept;
  void Refuse(Fault why) noexcept;
  void Accept(const device::ForceSample& sample, double elapsed) noexcept;

  DeviceGuardSettings settings_;
  GuardedDevice held_;
  std::uint64_t sequence_ = 0;
  double last_good_ = 0;  // [s]
  bool was_lost_ = true;
  bool was_stale_ = false;
  int jumps_in_row_ = 0;
  std::uint32_t window_ = 0;  // a bit for each of the last kWindow reports, set where it was bad or a jump
  Fault last_refusal_ = Fault::kNone;
  DeviceGuardCounts counts_;
};

struct LoopGuardSettings {
  double period = 0.001;           ///< [s]
  double soften_lateness = 0.005;  ///< late by more: the stiffness falls [s] (D9)
  double stop_lateness = 0.020;    ///< late by more: no force [s]
  double softened = 0.5;           ///< the stiffness it falls to [-]
  double recovery_time = 0.5;      ///< back to the whole [s]
};

/// Consequence of a tick's lateness.
struct LoopTiming {
  double stiffness_scale = 1;  ///< [-]
  Fault fault = Fault::kNone;  ///< kOverrun
  bool is_late = false;        ///< by more than half a period; counted
};

/// Judges by how much each tick is late (D9).
class LoopGuard {
 public:
  explicit LoopGuard(const LoopGuardSettings& settings = {}) noexcept : settings_(settings) {}

  /// \param lateness  start of this tick against its due time [s]
  /// \note Real-time safe.
  LoopTiming Step(double lateness) noexcept;

 private:
  LoopGuardSettings settings_;
  double stiffness_scale_ = 1;
};

}  // namespace trocar::haptics
