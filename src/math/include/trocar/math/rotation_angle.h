// SPDX-License-Identifier: Apache-2.0
/// \file rotation_angle.h  How far orientations lie apart, and whether a quaternion is one at all.
#pragma once

#include <algorithm>
#include <cmath>

#include "trocar/math/pose.h"

namespace trocar::math {

/// 1 for an orientation [-]; NaN where a component is.
inline double SquaredNorm(const Quaternion& q) noexcept {
  return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}

/// Between two orientations, 0 to pi; q and -q are one [rad].
inline double AngleBetween(const Quaternion& a, const Quaternion& b) noexcept {
  return 2.0 * std::acos(std::min(1.0, std::fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z)));
}

}  // namespace trocar::math
