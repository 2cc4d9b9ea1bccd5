// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/device_guard.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "guards.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::haptics {
namespace {

/// Reports that are nearer in time than this are judged as if this far apart [s]: a burst is no jump.
constexpr double kShortestGap = 0.0005;
/// Encoders make small steps at once; below this no motion is a jump [m], [rad].
constexpr double kSmallStep = 0.0005;
constexpr double kSmallTurn = 0.02;

bool IsPlausible(const device::ForceSample& sample, double max_reach) noexcept {
  // false for NaN
  return math::Norm(sample.position) <= max_reach &&
         std::fabs(math::SquaredNorm(sample.orientation) - 1.0) < 0.1;
}

}  // namespace

void DeviceGuard::Accept(const device::ForceSample& sample, double elapsed) noexcept {
  if (held_.has_pose) {
    const math::Vec3 velocity = (sample.position - held_.position) / elapsed;
    const double share = elapsed / (elapsed + settings_.velocity_time);
    held_.velocity += share * (velocity - held_.velocity);
  }
  held_.position = sample.position;
  held_.orientation = math::Normalized(sample.orientation);
  held_.has_pose = true;
  held_.buttons = sample.buttons;
  held_.jaw = sample.jaw;
  held_.temperature = sample.temperature;
  held_.is_warm = sample.status == device::ForceDeviceStatus::kWarm;
  held_.is_calibrated = sample.is_calibrated;
  jumps_in_row_ = 0;
  ++counts_.good;
}

/// A report that is not believed counts against the device for the next kWindow.
void DeviceGuard::Refuse(Fault why) noexcept {
  window_ |= 1;
  last_refusal_ = why;
}

/// A report that has not been seen before.
void DeviceGuard::Take(const device::ForceSample& sample, double now) noexcept {
  window_ <<= 1;
  if (IsOn(Guard::kBadSamples) && !IsPlausible(sample, settings_.max_reach)) {
    ++counts_.bad;
    return Refuse(Fault::kBadSamples);
  }
  const double elapsed = std::max(now - last_good_, kShortestGap);
  if (IsOn(Guard::kJump) && held_.has_pose) {
    const double moved = math::Distance(sample.position, held_.position);
    const double turned = math::AngleBetween(math::Normalized(sample.orientation), held_.orientation);
    if (moved > settings_.max_speed * elapsed + kSmallStep ||
        turned > settings_.max_turn_rate * elapsed + kSmallTurn) {
      ++counts_.jumps;
      Refuse(Fault::kJump);
      if (++jumps_in_row_ < settings_.max_refused) return;
      // it stays there: that is where it is, and what it came through is not known
      held_.has_pose = false;
      held_.velocity = {};
    }
  }
  Accept(sample, elapsed);
  last_good_ = now;
}

GuardedDevice DeviceGuard::Step(const device::ForceSample& sample, double now) noexcept {
  held_.fault = Fault::kNone;
  if (IsOn(Guard::kLost) && sample.status == device::ForceDeviceStatus::kLost) {
    was_lost_ = true;
    held_ = {};
    return held_;
  }
  const bool is_back = std::exchange(was_lost_, false);
  if (is_back) {
    jumps_in_row_ = 0;
    window_ = 0;
  }
  // of a device that is back what it reported before is taken, too; 0 is no report yet
  const bool is_new = is_back ? sample.sequence > 0 : sample.sequence != sequence_;
  sequence_ = sample.sequence;
  if (is_new) Take(sample, now);
  if (std::popcount(window_) >= settings_.max_refused) held_.fault = last_refusal_;
  // bad reports and jumps do not count as signs of life, so a device that only sends those goes silent
  const double age = IsOn(Guard::kSilence) ? now - last_good_ : 0.0;
  held_.scale =
      std::clamp((settings_.silent_age - age) / (settings_.silent_age - settings_.stale_age), 0.0, 1.0);
  const bool is_stale = age > settings_.stale_age;
  if (is_stale && !was_stale_) ++counts_.silences;
  was_stale_ = is_stale;
  if (is_stale) held_.velocity = {};
  if (age >= settings_.silent_age) {
    held_.buttons = 0;
    if (held_.fault == Fault::kNone) held_.fault = Fault::kSilent;
  }
  if (!held_.has_pose && held_.fault == Fault::kNone) held_.fault = Fault::kSilent;
  return held_;
}

LoopTiming LoopGuard::Step(double lateness) noexcept {
  LoopTiming timing;
  timing.is_late = lateness > 0.5 * settings_.period;
  stiffness_scale_ = std::min(
      1.0, stiffness_scale_ + (1.0 - settings_.softened) * settings_.period / settings_.recovery_time);
  if (IsOn(Guard::kOverrun) && !(lateness <= settings_.soften_lateness))
    stiffness_scale_ = settings_.softened;
  if (IsOn(Guard::kOverrun) && !(lateness <= settings_.stop_lateness)) timing.fault = Fault::kOverrun;
  timing.stiffness_scale = stiffness_scale_;
  return timing;
}

}  // namespace trocar::haptics
