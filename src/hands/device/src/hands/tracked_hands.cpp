// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/tracked_hands.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/rotation_angle.h"

namespace trocar::device {

using math::Pose;

namespace {

/// Noise and rounding of a sensor at rest: FASTRAK in ASCII steps by 0.25 mm and 0.01 degrees.
constexpr double kPositionSlack = 0.004;  // [m]
constexpr double kAngleSlack = 0.05;      // [rad]
constexpr double kReach = 5.0;            // of any tracker here [m]
/// So many doubtful poses in a row and the hand is not seen (faults D4).
constexpr int kBadInRow = 3;

bool IsPlausible(const Pose& pose) noexcept {
  // false for NaN
  return math::Norm(pose.translation) <= kReach && std::fabs(math::SquaredNorm(pose.rotation) - 1.0) <= 0.05;
}

/// `spin` or that plus whole turns, whichever is nearest to `before`.
double Unwrapped(double spin, double before) noexcept {
  constexpr double kTurn = 6.283185307179586;
  return spin + kTurn * std::round((before - spin) / kTurn);
}

}  // namespace

void TrackedHands::Reset() noexcept {
  hands_ = {};
  counts_ = {};
  is_new_ = false;
}

/// True if the pose may be used, its hemisphere put right.
bool TrackedHands::Gate(Hand& hand, Pose& pose, double time) noexcept {
  if (!IsPlausible(pose)) {
    ++counts_.implausible;
    return false;
  }
  pose.rotation = math::Normalized(pose.rotation);
  const double gap = std::max(0.0, time - hand.time);
  if (!hand.has_pose || gap > settings_.lost_after) {
    // nothing to compare with: the side on which the hands are said to be
    if (settings_.has_hemisphere_doubt && math::Dot(pose.translation, settings_.hemisphere) < 0.0) {
      pose.translation = -pose.translation;
      ++counts_.flips;
    }
    return true;
  }
  const math::Vec3 before = hand.X_source_sensor.translation;
  if (settings_.has_hemisphere_doubt &&
      math::SquaredDistance(-pose.translation, before) < math::SquaredDistance(pose.translation, before)) {
    pose.translation = -pose.translation;
    ++counts_.flips;
  }
  if (math::Distance(pose.translation, before) > kPositionSlack + settings_.max_speed * gap ||
      math::AngleBetween(pose.rotation, hand.X_source_sensor.rotation) >
          kAngleSlack + settings_.max_turn_rate * gap) {
    ++counts_.jumps;
    return false;
  }
  return true;
}

void TrackedHands::Accept(int channel, const Pose& X_source_sensor, double time) noexcept {
  if (channel < 0 || channel >= kChannelCount) return;
  Hand& hand = hands_[static_cast<std::size_t>(channel)];
  Pose pose = X_source_sensor;
  if (!Gate(hand, pose, time)) {
    if (++hand.bad_in_row == kBadInRow) {
      hand.sample.is_valid = false;
      is_new_ = true;
    }
    return;
  }
  const double spin_before = hand.sample.spin;
  const bool had_pose = hand.has_pose;
  hand.X_source_sensor = pose;
  hand.time = time;
  hand.has_pose = true;
  hand.bad_in_row = 0;
  SetJoints(settings_.calibrations[static_cast<std::size_t>(channel)], settings_.R_world_source, pose,
            hand.sample);
  if (had_pose) hand.sample.spin = Unwrapped(hand.sample.spin, spin_before);
  hand.sample.time = time;
  hand.sample.is_valid = true;
  ++counts_.accepted;
  is_new_ = true;
}

bool TrackedHands::Collect(double now, std::span<HandSample> samples) noexcept {
  for (std::size_t channel = 0; channel < hands_.size(); ++channel) {
    Hand& hand = hands_[channel];
    if (hand.sample.is_valid && now - hand.time > settings_.stale_after) {
      hand.sample.is_valid = false;
      is_new_ = true;
    }
    samples[channel] = hand.sample;
  }
  const bool was_new = is_new_;
  is_new_ = false;
  return was_new;
}

const Pose* TrackedHands::GetPose(int channel) const noexcept {
  if (channel < 0 || channel >= kChannelCount) return nullptr;
  const Hand& hand = hands_[static_cast<std::size_t>(channel)];
  return hand.has_pose ? &hand.X_source_sensor : nullptr;
}

}  // namespace trocar::device
