// SPDX-License-Identifier: Apache-2.0
/// \file stylus_hand.h  A haptic device's stylus as an instrument.
#pragma once

#include <algorithm>
#include <cmath>

#include "trocar/device/force_driver.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::device {

/// No stylus reaches farther from its device's origin [m].
inline constexpr double kFarthestStylus = 2.0;

/// The stylus's point as the tip of an instrument in a virtual trocar; the first button closes the jaws.
///
/// \param p_device_trocar  above the middle of the workspace, device frame [m]
inline void SetHand(const ForceSample& report, const math::Vec3& p_device_trocar, HandSample& hand) noexcept {
  // false for what is no number
  hand.is_valid = report.sequence > 0 && report.is_calibrated &&
                  math::Norm(report.position) <= kFarthestStylus &&
                  std::fabs(math::SquaredNorm(report.orientation) - 1.0) < 0.1;
  if (!hand.is_valid) return;
  // device: x right, y up, z towards the person; world: x right, y away from the person, z up
  const math::Vec3 way = report.position - p_device_trocar;
  const math::Vec3 a = math::Normalized(math::Vec3{way.x, -way.z, way.y}, {0, 0, -1});
  hand.pan = std::atan2(-a.x, -a.z);
  hand.tilt = std::asin(std::clamp(a.y, -1.0, 1.0));
  hand.depth = math::Norm(way);
  hand.spin = 2.0 * std::atan2(report.orientation.z, report.orientation.w);
  hand.jaw = (report.buttons & 1u) != 0 ? 0.0 : HandLimits{}.max_jaw;
  hand.buttons = report.buttons >> kStylusOwnButtons;
}

}  // namespace trocar::device
