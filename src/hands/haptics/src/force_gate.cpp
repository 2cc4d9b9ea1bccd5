// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/force_gate.h"

#include <algorithm>
#include <cmath>

#include "guards.h"

namespace trocar::haptics {
namespace {

/// No hand is as fast [m/s].
constexpr double kFastest = 100;
/// Share of the continuous force that is left to a device that calls itself warm [-].
constexpr double kWarmShare = 0.5;
/// Heat at which the derating begins, so that a steady force ends at the continuous one [-].
constexpr double kDeratingHeat = 0.8;

/// The scales of speed, heat and ramp rise by at most tick / short_ramp_time, which adds to the force, too: what
/// is left of max_rise for the wanted force itself [N].
double CalcRiseLimit(const GateSettings& settings) noexcept {
  return settings.max_rise - settings.tick / settings.short_ramp_time * settings.max_force;
}

/// Whether a gate can keep its promises with these settings; false for what is no number.
bool AreUsable(const GateSettings& settings) noexcept {
  return settings.tick > 0.0 && settings.tick <= 0.1 && settings.max_force >= device::kSmallestForceLimit &&
         settings.max_force <= device::kLargestForceLimit && settings.max_continuous_force > 0.0 &&
         settings.max_continuous_force <= settings.max_force && settings.guard_speed > 0.0 &&
         settings.max_speed > settings.guard_speed && settings.max_speed < kFastest &&
         CalcRiseLimit(settings) > 0.0;
}

/// Share that is left of a force that drives a fast device on.
double CalcSpeedShare(const GateSettings& settings, const math::Vec3& force,
                      const math::Vec3& velocity) noexcept {
  if (math::Dot(force, velocity) <= 0.0) return 1.0;
  const double speed = math::Norm(velocity);
  return std::clamp((settings.max_speed - speed) / (settings.max_speed - settings.guard_speed), 0.0, 1.0);
}

/// Share of the force that the motors' heat allows.
double CalcHeatShare(const GateSettings& settings, double size, double heat, bool is_warm) noexcept {
  double allowed = kWarmShare * settings.max_continuous_force;
  if (!is_warm) {
    if (heat <= kDeratingHeat) return 1.0;
    const double room = (1.0 - heat) / (1.0 - kDeratingHeat);
    allowed = settings.max_continuous_force + (settings.max_force - settings.max_continuous_force) * room;
  }
  return std::min(1.0, allowed / size);
}

}  // namespace

GateSettings MakeGateSettings(const device::ForceLimits& limits, double tick) noexcept {
  GateSettings settings;
  settings.tick = tick;
  settings.max_force = limits.max_force;
  settings.max_continuous_force = limits.max_continuous_force > 0.0
                                      ? std::min(limits.max_continuous_force, limits.max_force)
                                      : 0.25 * limits.max_force;
  return settings;
}

std::string_view ArmStateName(ArmState state) noexcept {
  switch (state) {
    case ArmState::kUnarmed:
      return "unarmed";
    case ArmState::kRamping:
      return "ramping";
    case ArmState::kArmed:
      return "armed";
  }
  return "unknown";
}

bool MaySend(const GateSettings& settings, ArmState state, const math::Vec3& force,
             const math::Vec3& sent) noexcept {
  if (force == math::Vec3{}) return true;
  return state != ArmState::kUnarmed &&
         math::Norm(force) <= settings.max_force * (1.0 + device::kForceRounding) &&
         device::CalcRise(force, sent) <= settings.max_rise + device::kForceRounding;
}

ForceGate::ForceGate(const GateSettings& settings)
    : settings_(settings), is_broken_(IsOn(Guard::kSettings) && !AreUsable(settings)) {
  if (is_broken_) reason_ = Fault::kGate;
}

void ForceGate::RequestArm() noexcept {
  if (state_ == ArmState::kUnarmed)
    request_ticks_ = static_cast<int>(std::lround(settings_.request_life / settings_.tick));
}

void ForceGate::Stop() noexcept {
  is_stopping_ = true;
}

/// The first thing that forbids force in this tick.
Fault ForceGate::FindFaultOfTick(const GateInput& input) const noexcept {
  if (is_broken_) return Fault::kGate;
  if (is_stopping_) return Fault::kStopped;
  if (input.fault != Fault::kNone) return input.fault;
  // finite, unit
  if (IsOn(Guard::kFinite) && (!math::IsFinite(input.force.newton) || !std::isfinite(input.scale)))
    return Fault::kForceNotFinite;
  if (IsOn(Guard::kPlausible) &&
      math::Norm(input.force.newton) > settings_.implausible_factor * settings_.max_force)
    return Fault::kForceImplausible;
  if (!math::IsFinite(input.velocity)) return Fault::kBadSamples;
  const bool drives_on = math::Dot(limited_, input.velocity) > 0.0 && scale_ > 0.0;
  if (IsOn(Guard::kSpeed) && drives_on && math::Norm(input.velocity) >= settings_.max_speed)
    return Fault::kOverspeed;
  if (IsOn(Guard::kHeat) && input.temperature >= 1.0) return Fault::kOverheated;
  const ArmingConditions& c = input.conditions;
  if (IsOn(Guard::kSupervisor) && !c.is_supervised) return Fault::kSupervisor;
  if (!c.is_calibrated) return Fault::kNotCalibrated;
  if (IsOn(Guard::kCheckPose) && !c.is_pose_confirmed) return Fault::kPoseUnconfirmed;
  if (!c.is_simulation_healthy) return Fault::kSimulation;
  if (IsOn(Guard::kDeadMan) && !c.is_dead_man_held) return Fault::kDeadMan;
  return Fault::kNone;
}

/// Unarmed -> ramping by a request that meets good conditions; ramping -> armed by time; any -> unarmed by a fault.
void ForceGate::UpdateArming(Fault fault, double wanted) noexcept {
  is_stopping_ = false;
  if (fault != Fault::kNone) {
    state_ = ArmState::kUnarmed;
    reason_ = fault;
    // no wish outlives a fault
    request_ticks_ = IsOn(Guard::kLatch) ? 0 : 1 << 20;
    ramp_ = 0;
    good_ticks_ = 0;
    ++fault_ticks_;
    return;
  }
  switch (state_) {
    case ArmState::kUnarmed:
      ++fault_ticks_;
      if (request_ticks_ == 0) break;
      --request_ticks_;
      if (wanted >= settings_.max_arming_force) {
        good_ticks_ = 0;
        reason_ = Fault::kForceAtArming;
      } else if (++good_ticks_ >= settings_.arming_ticks) {
        const bool is_short = was_armed_ && fault_ticks_ * settings_.tick <= settings_.short_fault_time;
        ramp_rise_ = settings_.tick / (is_short ? settings_.short_ramp_time : settings_.ramp_time);
        if (!IsOn(Guard::kRamp)) ramp_rise_ = 1.0;
        state_ = ArmState::kRamping;
        reason_ = Fault::kNone;
        was_armed_ = false;
      }
      break;
    case ArmState::kRamping:
      ramp_ = std::min(1.0, ramp_ + ramp_rise_);
      if (ramp_ >= 1.0) state_ = ArmState::kArmed;
      break;
    case ArmState::kArmed:
      was_armed_ = true;
      fault_ticks_ = 0;
      break;
  }
}

/// All stages but the last look.
GateOutput ForceGate::LimitForce(const GateInput& input) noexcept {
  GateOutput output;
  const Fault fault = FindFaultOfTick(input);
  math::Vec3 force = fault == Fault::kNone ? input.force.newton : math::Vec3{};
  // clamp
  const double size = math::Norm(force);
  if (IsOn(Guard::kClamp) && size > settings_.max_force) {
    force *= settings_.max_force / size;
    output.limits |= kClamped;
  }
  // armed
  UpdateArming(fault, math::Norm(force));
  if (IsOn(Guard::kArmed) && state_ == ArmState::kUnarmed) {
    scale_ = 0;
    return {};
  }
  // rise
  limited_ = IsOn(Guard::kRise) ? device::LimitRise(force, limited_, CalcRiseLimit(settings_)) : force;
  if (!(limited_ == force)) output.limits |= kRiseLimited;
  // speed, heat
  const double speed_share = IsOn(Guard::kSpeed) ? CalcSpeedShare(settings_, limited_, input.velocity) : 1.0;
  if (speed_share < 1.0) output.limits |= kSpeedLimited;
  const bool is_warm = input.is_warm || input.temperature >= settings_.warm_temperature;
  const double heat_share =
      IsOn(Guard::kHeat) ? CalcHeatShare(settings_, math::Norm(limited_), heat_, is_warm) : 1.0;
  if (heat_share < 1.0) output.limits |= kHeatLimited;
  // ramp; the scales fall at once and rise slowly
  const double asked = std::clamp(input.scale, 0.0, 1.0) * speed_share * heat_share * ramp_;
  const double rise = IsOn(Guard::kRamp) ? settings_.tick / settings_.short_ramp_time : 1.0;
  scale_ = std::min(asked, scale_ + rise);
  output.force = device::GatedForce(IsOn(Guard::kArmed) ? scale_ * limited_ : limited_);
  return output;
}

GateOutput ForceGate::Step(const GateInput& input) noexcept {
  GateOutput output = LimitForce(input);
  if (IsOn(Guard::kOutput) && !MaySend(settings_, state_, output.force.Get(), sent_)) {
    // what should be impossible: the tick once more by a broken gate, which is zero for good
    is_broken_ = true;
    output = LimitForce(input);
  }
  sent_ = output.force.Get();
  const double load = math::Norm(output.force.Get()) / settings_.max_continuous_force;
  heat_ += settings_.tick / settings_.heat_time * (load * load - heat_);
  output.state = state_;
  output.reason = reason_;
  output.heat = heat_;
  return output;
}

}  // namespace trocar::haptics
