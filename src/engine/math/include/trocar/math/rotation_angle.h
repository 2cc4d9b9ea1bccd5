// SPDX-License-Identifier: Apache-2.0
/// \file rotation_angle.h  How far orientations or directions lie apart, and whether a quaternion is one at all.
#pragma once

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"
#include "trocar/math/pose.h"

namespace trocar::math {

inline constexpr double kDegree = M_PI / 180.0;  ///< [rad]

/// 1 for an orientation [-]; NaN where a component is.
inline double SquaredNorm(const Quaternion& q) noexcept {
  return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}

/// Between two orientations, 0 to pi; q and -q are one [rad].
inline double AngleBetween(const Quaternion& a, const Quaternion& b) noexcept {
  return 2.0 * Acos(std::min(1.0, std::fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z)));
}

/// Between two directions of any length but 0, 0 to pi [rad].
inline double AngleBetween(const Vec3& a, const Vec3& b) noexcept {
  return Acos(std::clamp(Dot(Normalized(a), Normalized(b)), -1.0, 1.0));
}

}  // namespace trocar::math
