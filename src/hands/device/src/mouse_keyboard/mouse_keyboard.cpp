// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/mouse_keyboard.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace trocar::device {
namespace {

/// Below this a wheel motion has been walked [m]; far below what is seen or felt.
constexpr double kWheelRest = 1e-7;
/// Shortest lever that pointer motion is divided by [m].
constexpr double kShortestLever = 0.01;

/// Changes `rate` towards `target` by at most one unit in `ramp` seconds.
/// \return the integral of the rate over dt, exact for the straight ramp
double AdvanceRamp(double& rate, double target, double ramp, double dt) noexcept {
  const double ramp_left = std::fabs(target - rate) * ramp;
  if (ramp_left <= dt) {
    const double way = 0.5 * (rate + target) * ramp_left + target * (dt - ramp_left);
    rate = target;
    return way;
  }
  const double before = rate;
  rate += std::copysign(dt / ramp, target - rate);
  return 0.5 * (before + rate) * dt;
}

/// Like std::clamp, but defined for limits that Configure() would refuse.
double Clamp(double value, double low, double high) noexcept {
  return std::max(low, std::min(value, high));
}

HandSample Clamp(HandSample sample, const HandLimits& limits) noexcept {
  sample.pan = Clamp(sample.pan, -limits.max_pan, limits.max_pan);
  sample.tilt = Clamp(sample.tilt, -limits.max_tilt, limits.max_tilt);
  sample.depth = Clamp(sample.depth, limits.min_depth, limits.max_depth);
  sample.jaw = Clamp(sample.jaw, 0.0, limits.max_jaw);
  return sample;
}

JointRates Sum(const JointRates& a, double ka, const JointRates& b, double kb, const JointRates& c,
               double kc) noexcept {
  return {ka * a.pan + kb * b.pan + kc * c.pan, ka * a.tilt + kb * b.tilt + kc * c.tilt,
          ka * a.depth + kb * b.depth + kc * c.depth};
}

base::Error SettingsError(const std::string& text) {
  return {base::ErrorCode::kDeviceSettings, "mouse and keyboard: " + text};
}

}  // namespace

MouseKeyboard::MouseKeyboard(const MouseKeyboardSettings& settings)
    : Driver("mouse and keyboard", kChannelCount), settings_(settings) {
  for (HandSample& sample : samples_) sample.depth = 0.1;
}

base::Status MouseKeyboard::DoConfigure() {
  const std::pair<const char*, double> positive[] = {
      {"metres_per_pixel", settings_.metres_per_pixel},
      {"metres_per_step", settings_.metres_per_step},
      {"wheel_time", settings_.wheel_time},
      {"tip_rate", settings_.tip_rate},
      {"spin_rate", settings_.spin_rate},
      {"jaw_rate", settings_.jaw_rate},
      {"ramp_time", settings_.ramp_time},
      {"max_pointer_speed", settings_.max_pointer_speed},
  };
  for (const auto& [name, value] : positive) {
    if (!(value > 0.0) || !std::isfinite(value))
      return SettingsError(std::string(name) + " must be greater than 0");
  }
  for (const HandLimits& limits : settings_.limits) {
    const bool is_good = limits.max_pan >= 0.0 && limits.max_tilt >= 0.0 && limits.max_jaw >= 0.0 &&
                         limits.min_depth > 0.0 && limits.max_depth >= limits.min_depth;
    if (!is_good) return SettingsError("a limit is negative, not a number, or its minimum above its maximum");
    if (!(settings_.shaft_length > limits.max_depth)) {
      return SettingsError("shaft_length must be greater than every max_depth, or no handle is left outside");
    }
  }
  return {};
}

base::Status MouseKeyboard::DoActivate() {
  ReleaseAll();
  time_ = 0.0;
  is_fresh_ = true;
  for (int channel = 0; channel < kChannelCount; ++channel) {
    HandSample& sample = samples_[channel];
    sample = Clamp(sample, settings_.limits[channel]);
    sample.time = 0.0;
    sample.is_valid = true;
  }
  return {};
}

void MouseKeyboard::DoDeactivate() noexcept {
  ReleaseAll();
  for (HandSample& sample : samples_) sample.is_valid = false;
}

void MouseKeyboard::DoCleanup() noexcept {}

ReadStatus MouseKeyboard::DoRead(std::span<HandSample> samples) noexcept {
  std::copy(samples_.begin(), samples_.end(), samples.begin());
  return std::exchange(is_fresh_, false) ? ReadStatus::kFresh : ReadStatus::kUnchanged;
}

void MouseKeyboard::Place(Channel channel, const HandSample& sample) noexcept {
  if (!IsFinite(sample)) return;
  HandSample placed = Clamp(sample, settings_.limits[channel]);
  placed.time = time_;
  placed.is_valid = samples_[channel].is_valid;
  samples_[channel] = placed;
  is_fresh_ = true;
  if (channel == chosen_) {
    rates_.fill(0.0);
    pointer_right_ = pointer_up_ = wheel_ = 0.0;
  }
}

void MouseKeyboard::Choose(Channel channel) noexcept {
  if (channel == chosen_) return;
  chosen_ = channel;
  rates_.fill(0.0);
  pointer_right_ = pointer_up_ = wheel_ = 0.0;
}

void MouseKeyboard::SetPointerMap(Channel channel, const PointerMap& map) noexcept {
  for (const JointRates& rates : {map.right, map.up, map.away}) {
    if (!std::isfinite(rates.pan) || !std::isfinite(rates.tilt) || !std::isfinite(rates.depth)) return;
  }
  maps_[channel] = map;
  has_map_[channel] = true;
}

void MouseKeyboard::SetMetresPerPixel(double metres) noexcept {
  if (metres > 0.0 && std::isfinite(metres)) settings_.metres_per_pixel = metres;
}

void MouseKeyboard::MovePointer(double dx, double dy) noexcept {
  if (!std::isfinite(dx) || !std::isfinite(dy)) return;
  pointer_right_ += settings_.metres_per_pixel * dx;
  pointer_up_ -= settings_.metres_per_pixel * dy;
}

void MouseKeyboard::Scroll(double steps) noexcept {
  if (std::isfinite(steps)) wheel_ += settings_.metres_per_step * steps;
}

void MouseKeyboard::SetKey(Motion motion, bool is_down) noexcept {
  is_down_[static_cast<int>(motion)] = is_down;
}

void MouseKeyboard::ReleaseAll() noexcept {
  is_down_.fill(false);
  rates_.fill(0.0);
  pointer_right_ = pointer_up_ = wheel_ = 0.0;
}

PointerMap MouseKeyboard::CalcMap() const noexcept {
  if (has_map_[chosen_]) return maps_[chosen_];
  const double lever = std::max(samples_[chosen_].depth, kShortestLever);
  return {{-1.0 / lever, 0.0, 0.0}, {0.0, 1.0 / lever, 0.0}, {0.0, 0.0, 1.0}};
}

void MouseKeyboard::MoveInPicture(double right, double up, double away) noexcept {
  HandSample& sample = samples_[chosen_];
  const PointerMap map = CalcMap();
  JointRates way;
  if (settings_.mirror_fulcrum && chosen_ != kLaparoscope) {
    // the handle moves: about the trocar the tip goes the other way, along the shaft it goes with the hand
    way = Sum(map.right, right, map.up, up, {}, 0.0);
    const double ratio = -sample.depth / (settings_.shaft_length - sample.depth);
    way.pan *= ratio;
    way.tilt *= ratio;
    way.depth += away;
  } else {
    way = Sum(map.right, right, map.up, up, map.away, away);
  }
  sample.pan += way.pan;
  sample.tilt += way.tilt;
  sample.depth += way.depth;
}

void MouseKeyboard::Advance(double dt) noexcept {
  if (GetState() != DriverState::kActive) return;
  dt = dt > 0.0 ? std::min(dt, kLongestStep) : 0.0;
  time_ += dt;
  is_fresh_ = true;

  // pointer: what was moved since the last call, cut off at the fastest believable speed
  const double pointer = std::hypot(pointer_right_, pointer_up_);
  const double most = settings_.max_pointer_speed * dt;
  const double kept = pointer > most ? most / pointer : 1.0;
  double right = kept * pointer_right_, up = kept * pointer_up_, away = 0.0;
  pointer_right_ = pointer_up_ = 0.0;

  // wheel: walked with a time constant, so that a step is no jump
  double walked = wheel_ * -std::expm1(-dt / settings_.wheel_time);
  if (std::fabs(wheel_ - walked) < kWheelRest) walked = wheel_;
  wheel_ -= walked;
  away += walked;

  // keys: every direction ramps up and down on its own
  const auto held = [this](Motion plus, Motion minus) {
    return double(is_down_[static_cast<int>(plus)]) - double(is_down_[static_cast<int>(minus)]);
  };
  const auto advance = [&](Axis axis, Motion plus, Motion minus) {
    return AdvanceRamp(rates_[axis], held(plus, minus), settings_.ramp_time, dt);
  };
  right += settings_.tip_rate * advance(kAxisRight, Motion::kRight, Motion::kLeft);
  up += settings_.tip_rate * advance(kAxisUp, Motion::kUp, Motion::kDown);
  away += settings_.tip_rate * advance(kAxisAway, Motion::kIn, Motion::kOut);
  HandSample& sample = samples_[chosen_];
  sample.spin += settings_.spin_rate * advance(kAxisSpin, Motion::kSpinRight, Motion::kSpinLeft);
  sample.jaw += settings_.jaw_rate * advance(kAxisJaw, Motion::kOpenJaw, Motion::kCloseJaw);

  if (right != 0.0 || up != 0.0 || away != 0.0) MoveInPicture(right, up, away);
  sample = Clamp(sample, settings_.limits[chosen_]);
  for (HandSample& each : samples_) each.time = time_;
}

}  // namespace trocar::device
