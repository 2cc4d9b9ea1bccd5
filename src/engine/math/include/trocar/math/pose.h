// SPDX-License-Identifier: Apache-2.0
/// \file pose.h  Rotations and rigid poses. X_world_tool maps tool coordinates to world coordinates.
#pragma once

#include "trocar/math/vector.h"

namespace trocar::math {

/// Unit quaternion w + xi + yj + zk; Hamilton product.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;

  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

/// Rotation by `angle` [rad] about the unit vector `axis`, right-handed.
Quaternion RotationAbout(const Vec3& axis, double angle);
/// First b, then a.
Quaternion operator*(const Quaternion& a, const Quaternion& b);
Quaternion Inverse(const Quaternion& q);
/// Restores unit length; the identity for a zero quaternion.
Quaternion Normalized(const Quaternion& q);
Vec3 Rotate(const Quaternion& q, const Vec3& v);
/// Shortest rotation that takes the unit vector `from` to the unit vector `to`.
Quaternion RotationBetween(const Vec3& from, const Vec3& to);
/// Rotation whose columns are the orthonormal right-handed axes x, y, z.
Quaternion RotationFromAxes(const Vec3& x, const Vec3& y, const Vec3& z);

/// Rigid pose: p_a = rotation * p_b + translation [m].
struct Pose {
  Quaternion rotation;
  Vec3 translation;

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// X_a_c = X_a_b * X_b_c
Pose operator*(const Pose& X_a_b, const Pose& X_b_c);
Pose Inverse(const Pose& X_a_b);
/// p_a = X_a_b * p_b
Vec3 operator*(const Pose& X_a_b, const Vec3& p_b);

}  // namespace trocar::math
