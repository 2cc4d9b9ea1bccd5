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

RateHands::RateHands(std::string name, Clock& clock) : Driver(std::move(name), kChannelCount), clock_(clock) {
  for (HandSample& hand : hands_) hand.depth = 0.1;
}

void RateHands::PlaceHand(int channel, const HandSample& home) noexcept {
  if (channel < 0 || channel >= kChannelCount || !IsFinite(home)) return;
  hands_[static_cast<std::size_t>(channel)] = home;
}

base::Status RateHands::DoActivate() {
  time_ = clock_.Now();
  return {};
}

double RateHands::Step() noexcept {
  const double now = clock_.Now();
  return std::clamp(now - std::exchange(time_, now), 0.0, kLongestStep);
}

ReadStatus RateHands::Publish(std::span<HandSample> samples) noexcept {
  for (const Channel hand : {kLeftHand, kRightHand}) {
    hands_[hand].time = time_;
    hands_[hand].is_valid = true;
  }
  hands_[kLaparoscope].is_valid = false;
  std::copy(hands_.begin(), hands_.end(), samples.begin());
  return ReadStatus::kFresh;
}

Gamepad::Gamepad(std::unique_ptr<GamepadSource> source, Clock& clock)
    : RateHands("gamepad", clock), source_(std::move(source)) {}

ReadStatus Gamepad::DoRead(std::span<HandSample> samples) noexcept {
  GamepadState state;
  if (!source_->Poll(state)) return ReadStatus::kLost;
  const double dt = Step();
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
    HandSample& hand = Hand(static_cast<Channel>(i));
    MoveHand(rates, dt, limits, hand);
    hand.jaw = limits.max_jaw * (1.0 - std::clamp(side.trigger, 0.0, 1.0));
    hand.buttons = side.buttons;
  }
  return Publish(samples);
}

SpaceMouse::SpaceMouse(std::unique_ptr<SpaceMouseSource> source, Clock& clock)
    : RateHands("spacemouse", clock), source_(std::move(source)) {}

base::Status SpaceMouse::DoActivate() {
  chosen_ = kRightHand;
  was_switch_down_ = false;
  return RateHands::DoActivate();
}

ReadStatus SpaceMouse::DoRead(std::span<HandSample> samples) noexcept {
  SpaceMouseState state;
  if (!source_->Poll(state)) return ReadStatus::kLost;
  const double dt = Step();
  if (state.is_button_down[1] && !was_switch_down_) chosen_ = chosen_ == kRightHand ? kLeftHand : kRightHand;
  was_switch_down_ = state.is_button_down[1];
  const auto rate = [](double counts) { return WithoutDeadZone(counts / kCapCounts, kCapDeadZone); };
  HandRates rates;
  rates.pan = -kAcross * rate(state.push[0]);
  rates.tilt = kAcross * rate(state.push[1]);
  rates.depth = -kIn * rate(state.push[2]);
  rates.spin = -kTurn * rate(state.turn[1]);
  rates.jaw = state.is_button_down[0] ? -kJaw : kJaw;
  MoveHand(rates, dt, {}, Hand(chosen_));
  for (const Channel hand : {kLeftHand, kRightHand})
    Hand(hand).buttons = hand == chosen_ ? state.more_buttons : 0;
  return Publish(samples);
}

}  // namespace trocar::device
