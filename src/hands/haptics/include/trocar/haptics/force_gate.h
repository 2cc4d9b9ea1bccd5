// SPDX-License-Identifier: Apache-2.0
/// \file force_gate.h  The one way out for a force.
///
/// finite -> unit and frame -> clamp -> armed -> rise -> speed -> heat -> ramp -> checked once more. A pure function of its input and a
/// small state; no clock, no device. Only its output is a device::GatedForce, and a driver sends nothing else.
#pragma once

#include <cstdint>

#include "trocar/device/force_check.h"
#include "trocar/device/force_driver.h"
#include "trocar/haptics/fault.h"

namespace trocar::haptics {

/// A force in the frame of its device, made by ToDeviceForce: one in the world's frame does not fit into the gate.
struct DeviceForce {
  math::Vec3 newton;  ///< on the hand [N]
};

struct GateSettings {
  double tick = 0.001;                      ///< period of Step [s], > 0
  double max_force = 0;                     ///< clamp [N], > 0
  double max_continuous_force = 0;          ///< [N], > 0 and <= max_force
  double max_rise = device::kMaxForceRise;  ///< what one tick may add; a fall is free [N]
  double implausible_factor =
      20;                         ///< a wanted force beyond this times max_force is an error, not a force [-]
  double guard_speed = 1.0;       ///< above which a force that drives the device on fades out [m/s]
  double max_speed = 2.0;         ///< at which it is a runaway [m/s]
  double heat_time = 20;          ///< time constant of the motors' heat [s]
  double warm_temperature = 0.9;  ///< of what a device reports, 1 is too hot [-]
  double ramp_time = 2.0;         ///< from unarmed to the full force [s]
  double short_ramp_time = 0.5;   ///< the same after a fault shorter than short_fault_time [s]
  double short_fault_time = 1.0;  ///< [s]
  double max_arming_force = 0.3;  ///< wanted force under which arming may begin [N]
  int arming_ticks = 4;           ///< for which all conditions must hold
  double request_life = 0.5;      ///< after which a request that was not met lapses [s]
};

/// Settings for a device; unknown continuous force counts as a quarter of the nominal maximum.
/// \param tick  [s]
GateSettings MakeGateSettings(const device::ForceLimits& limits, double tick) noexcept;

/// Conditions that have to hold before and while forces are sent.
struct ArmingConditions {
  bool is_supervised = false;          ///< the supervisor process watches (D10)
  bool is_calibrated = false;          ///< D13
  bool is_pose_confirmed = false;      ///< D13
  bool is_dead_man_held = false;       ///< D12
  bool is_simulation_healthy = false;  ///< S1
};

struct GateInput {
  DeviceForce force;           ///< wanted
  math::Vec3 velocity;         ///< of the device [m/s]
  double temperature = 0;      ///< of its motors, 1 is too hot; NaN where unknown [-]
  bool is_warm = false;        ///< the device says so
  double scale = 1;            ///< asked for by the guards of time and of silence, 0 to 1 [-]
  Fault fault = Fault::kNone;  ///< found by the guards before the gate
  ArmingConditions conditions;
};

enum class ArmState : std::uint8_t { kUnarmed, kRamping, kArmed };
/// "unarmed", "ramping", "armed"
std::string_view ArmStateName(ArmState state) noexcept;

/// Which stages changed the force of a tick; a set of bits.
enum GateLimit : std::uint8_t { kClamped = 1, kRiseLimited = 2, kSpeedLimited = 4, kHeatLimited = 8 };

struct GateOutput {
  device::GatedForce force;
  ArmState state = ArmState::kUnarmed;
  Fault reason = Fault::kNotRequested;  ///< why not armed; kNone while ramping and armed
  std::uint8_t limits = 0;              ///< GateLimit
  double heat = 0;                      ///< of the motors, 1 is what they bear for ever [-]
};

/// The gate's promises once more, by arithmetic of its own and on the force itself; false for what is no number.
/// \param sent  output of the tick before [N]
bool MaySend(const GateSettings& settings, ArmState state, const math::Vec3& force,
             const math::Vec3& sent) noexcept;

class ForceGate {
 public:
  /// A gate whose settings are out of range never arms, whatever the build: they come from a device.
  explicit ForceGate(const GateSettings& settings);

  /// A person asks for force. Arms once every condition has held for arming_ticks, or lapses.
  void RequestArm() noexcept;
  /// A person wants no force, from the next Step on.
  void Stop() noexcept;

  /// One tick.
  ///
  /// The output never exceeds max_force, is zero unless ramping or armed, and lies at most max_rise from the way
  /// between zero and the output before it. Each is checked once more on the output itself; should one not hold, it is
  /// zero, and the gate never arms again.
  /// \note Real-time safe: no allocation, lock or throw.
  GateOutput Step(const GateInput& input) noexcept;

  const GateSettings& GetSettings() const noexcept { return settings_; }

 private:
  Fault FindFaultOfTick(const GateInput& input) const noexcept;
  void UpdateArming(Fault fault, double wanted) noexcept;
  GateOutput LimitForce(const GateInput& input) noexcept;

  GateSettings settings_;
  ArmState state_ = ArmState::kUnarmed;
  Fault reason_ = Fault::kNotRequested;
  math::Vec3 sent_;       // output of the tick before [N]
  math::Vec3 limited_;    // after the rise stage of the tick before [N]
  double scale_ = 0;      // of speed, heat and ramp in the tick before [-]
  double ramp_ = 0;       // [-]
  double ramp_rise_ = 0;  // per tick [-]
  double heat_ = 0;       // [-]
  int good_ticks_ = 0;
  int request_ticks_ = 0;  // left of a request
  int fault_ticks_ = 0;    // since it was last fully armed
  bool was_armed_ = false;
  bool is_stopping_ = false;
  bool is_broken_ = false;  // settings or an output out of range: never again
};

}  // namespace trocar::haptics
