// SPDX-License-Identifier: Apache-2.0
/// \file tracked_hands.h  From poses of sensors to hands, with everything doubtful held back. Every tracker uses it.
/// Source: faults D2, D4, D5; hemisphere ambiguity of dipole fields: domain facts, section 6.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "trocar/device/hand_calibration.h"
#include "trocar/device/mouse_keyboard.h"

namespace trocar::device {

struct TrackedHandsSettings {
  std::array<HandCalibration, kChannelCount> calibrations;
  math::Quaternion R_world_source;   ///< see FindSourceRotation()
  math::Vec3 hemisphere{1, 0, 0};    ///< unit vector from the source to where the hands are, source frame
  bool has_hemisphere_doubt = true;  ///< the tracker may report -x for x; false for optical ones
  double max_speed = 2.0;            ///< of a sensor; what is faster is a glitch [m/s], > 0
  double max_turn_rate = 25.0;       ///< of a sensor; what is faster is a glitch [rad/s], > 0
  double stale_after = 0.050;        ///< without a good pose a hand is not seen any more [s], > 0
  double lost_after = 0.500;         ///< without any record the device is lost [s], > stale_after
};

/// Counts of poses since the last Reset(): accepted, turned back, and held back.
struct PoseCounts {
  std::uint64_t accepted = 0;
  std::uint64_t jumps = 0;        ///< faster than a hand
  std::uint64_t flips = 0;        ///< of the hemisphere, turned back
  std::uint64_t implausible = 0;  ///< not finite, or out of every reach
};

/// Three hands of a tracker.
/// \note Real-time safe: no allocation, lock or throw.
class TrackedHands {
 public:
  explicit TrackedHands(const TrackedHandsSettings& settings) noexcept : settings_(settings) {}

  void Reset() noexcept;
  /// A pose has come in.
  /// \param time  [s], not falling
  void Accept(int channel, const math::Pose& X_source_sensor, double time) noexcept;
  /// Writes all hands.
  /// \return true if anything is new, a hand that went out of sight included
  bool Collect(double now, std::span<HandSample> samples) noexcept;

  /// The last good pose of a channel's sensor, hemisphere put right; null before the first.
  const math::Pose* GetPose(int channel) const noexcept;
  const PoseCounts& Counts() const noexcept { return counts_; }

 private:
  struct Hand {
    math::Pose X_source_sensor;
    double time = 0;  // of that pose [s]
    bool has_pose = false;
    int bad_in_row = 0;
    HandSample sample;
  };
  bool Gate(Hand& hand, math::Pose& pose, double time) noexcept;

  TrackedHandsSettings settings_;
  std::array<Hand, kChannelCount> hands_;
  PoseCounts counts_;
  bool is_new_ = false;
};

}  // namespace trocar::device
