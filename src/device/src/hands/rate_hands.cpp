// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/rate_hands.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trocar::device {
namespace {

constexpr double kAcross = 0.7;       // pan and tilt at full deflection [rad/s]
constexpr double kTurn = 2.5;         // spin at full deflection [rad/s]
constexpr double kIn = 0.06;          // depth at full deflection [m/s]
constexpr double kJaw = 2.0;          // of a button [rad/s]
constexpr double kLongestStep = 0.1;  // a program that stood still makes no jump [s]
constexpr double kStickDeadZone = 0.12;
constexpr double kCapDeadZone = 0.05;
constexpr double kCapCounts = 350.0;  // of a full push

double StepSince(double& last, double now) noexcept {
  return std::clamp(now - std::exchange(last, now), 0.0, kLongestStep);
}

void PlaceIn(std::array<HandSample, kChannelCount>& hands, int channel, const HandSample& home) noexcept {
  if (channel < 0 || channel >= kChannelCount || !IsFinite(home)) return;
  hands[static_cast<std::size_t>(channel)] = home;
}

/// Hands at rest before anybody places them.
std::array<HandSample, kChannelCount> MakeHands() noexcept {
  std::array<HandSample, kChannelCount> hands;
  for (HandSample& hand : hands) hand.depth = 0.1;
  return hands;
}

}  // namespace

void MoveHand(const HandRates& rates, double dt, const HandLimits& limits, HandSample& hand) noexcept {
  hand.pan = std::clamp(hand.pan + dt * rates.pan, -limits.max_pan, limits.max_pan);
  hand.tilt = std::clamp(hand.tilt + dt * rates.tilt, -limits.max_tilt, limits.max_tilt);
  hand.spin += dt * rates.spin;
  hand.depth = std::clamp(hand.depth + dt * rates.depth, limits.min_depth, limits.max_depth);
  hand.jaw = std::clamp(hand.jaw + dt * rates.jaw, 0.0, limits.max_jaw);
}

double WithoutDeadZone(double deflection, double dead_zone) noexcept {
  const double size = std::fabs(deflection);
  if (!(size > dead_zone)) return 0.0;
  return std::copysign(std::min(1.0, (size - dead_zone) / (1.0 - dead_zone)), deflection);
}

Gamepad::Gamepad(std::unique_ptr<GamepadSource> source, Clock& clock)
    : Driver("gamepad", kChannelCount), source_(std::move(source)), clock_(clock), hands_(MakeHands()) {}

void Gamepad::PlaceHand(int channel, const HandSample& home) noexcept {
  PlaceIn(hands_, channel, home);
}

core::Status Gamepad::DoConfigure() {
  return source_->Open();
}

core::Status Gamepad::DoActivate() {
  time_ = clock_.Now();
  return {};
}

ReadStatus Gamepad::DoRead(std::span<HandSample> samples) noexcept {
  GamepadState state;
  if (!source_->Poll(state)) return ReadStatus::kLost;
  const double dt = StepSince(time_, clock_.Now());
  const HandLimits limits;
  for (std::size_t i = 0; i < state.sides.size(); ++i) {
    const GamepadState::Side& side = state.sides[i];
    const double x = WithoutDeadZone(side.x, kStickDeadZone), y = WithoutDeadZone(side.y, kStickDeadZone);
    HandRates rates;
    if (side.is_shoulder_down) {
      rates.spin = kTurn * x;
      rates.depth = -kIn * y;
    } else {
      rates.pan = -kAcross * x;
      rates.tilt = -kAcross * y;
    }
    MoveHand(rates, dt, limits, hands_[i]);
    hands_[i].jaw = limits.max_jaw * (1.0 - std::clamp(side.trigger, 0.0, 1.0));
    hands_[i].buttons = side.buttons;
    hands_[i].time = time_;
    hands_[i].is_valid = true;
  }
  hands_[kLaparoscope].is_valid = false;
  std::copy(hands_.begin(), hands_.end(), samples.begin());
  return ReadStatus::kFresh;
}

SpaceMouse::SpaceMouse(std::unique_ptr<SpaceMouseSource> source, Clock& clock)
    : Driver("spacemouse", kChannelCount), source_(std::move(source)), clock_(clock), hands_(MakeHands()) {}

void SpaceMouse::PlaceHand(int channel, const HandSample& home) noexcept {
  PlaceIn(hands_, channel, home);
}

core::Status SpaceMouse::DoConfigure() {
  return source_->Open();
}

core::Status SpaceMouse::DoActivate() {
  time_ = clock_.Now();
  chosen_ = kRightHand;
  was_switch_down_ = false;
  return {};
}

ReadStatus SpaceMouse::DoRead(std::span<HandSample> samples) noexcept {
  SpaceMouseState state;
  if (!source_->Poll(state)) return ReadStatus::kLost;
  const double dt = StepSince(time_, clock_.Now());
  if (state.is_button_down[1] && !was_switch_down_) chosen_ = chosen_ == kRightHand ? kLeftHand : kRightHand;
  was_switch_down_ = state.is_button_down[1];
  const auto rate = [](double counts) { return WithoutDeadZone(counts / kCapCounts, kCapDeadZone); };
  HandRates rates;
  rates.pan = -kAcross * rate(state.push[0]);
  rates.tilt = kAcross * rate(state.push[1]);
  rates.depth = -kIn * rate(state.push[2]);
  rates.spin = -kTurn * rate(state.turn[1]);
  rates.jaw = state.is_button_down[0] ? -kJaw : kJaw;
  MoveHand(rates, dt, {}, hands_[chosen_]);
  for (const Channel hand : {kLeftHand, kRightHand}) {
    hands_[hand].buttons = hand == chosen_ ? state.more_buttons : 0;
    hands_[hand].time = time_;
    hands_[hand].is_valid = true;
  }
  hands_[kLaparoscope].is_valid = false;
  std::copy(hands_.begin(), hands_.end(), samples.begin());
  return ReadStatus::kFresh;
}

}  // namespace trocar::device
