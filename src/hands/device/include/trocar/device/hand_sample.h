// SPDX-License-Identifier: Apache-2.0
/// \file hand_sample.h  Sample of an input device: one hand at one time.
#pragma once

#include <cmath>
#include <cstdint>

namespace trocar::device {

/// The four degrees of freedom of a shaft in a trocar, and the jaws; angles as in
/// instrument/trocar_kinematics.h.
struct HandSample {
  double pan = 0;         ///< about the y axis of the world [rad]
  double tilt = 0;        ///< about the panned x axis [rad]
  double spin = 0;        ///< about the shaft [rad]
  double depth = 0;       ///< from the trocar point to the tip [m]
  double jaw = 0;         ///< whole opening of the jaws [rad]
  double time = 0;        ///< of the device's own clock [s]
  bool is_valid = false;  ///< false: the hand is not seen; hold its last pose
  /// Buttons and pedals of this hand that are down: bit n is button n + 1, as HandButtons reads them.
  std::uint32_t buttons = 0;

  friend bool operator==(const HandSample&, const HandSample&) = default;
};

/// True if every number is finite.
inline bool IsFinite(const HandSample& sample) noexcept {
  return std::isfinite(sample.pan) && std::isfinite(sample.tilt) && std::isfinite(sample.spin) &&
         std::isfinite(sample.depth) && std::isfinite(sample.jaw) && std::isfinite(sample.time);
}

/// Interval that each joint of a hand stays in.
struct HandLimits {
  double max_pan = 1.3962634015954636;   ///< to both sides, 80 deg [rad]
  double max_tilt = 1.3962634015954636;  ///< to both sides, 80 deg [rad]
  double min_depth = 0.030;              ///< [m]
  double max_depth = 0.280;              ///< [m]
  double max_jaw = 1.0471975511965976;   ///< 60 deg [rad]
};

}  // namespace trocar::device
