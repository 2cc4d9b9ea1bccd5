// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/pose.h"

#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::math {

Quaternion RotationAbout(const Vec3& axis, double angle) {
  const auto [s, c] = SinCos(0.5 * angle);
  return {c, s * axis.x, s * axis.y, s * axis.z};
}

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion Inverse(const Quaternion& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

Quaternion Normalized(const Quaternion& q) {
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(norm > 0.0)) return {};
  return {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
}

Vec3 Rotate(const Quaternion& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * Cross(u, v);
  return v + q.w * t + Cross(u, t);
}

Quaternion RotationBetween(const Vec3& from, const Vec3& to) {
  const double cosine = Dot(from, to);
  if (cosine < -1.0 + 1e-12) return RotationAbout(AnyPerpendicular(from), M_PI);
  const Vec3 axis = Cross(from, to);
  return Normalized(Quaternion{1.0 + cosine, axis.x, axis.y, axis.z});
}

Quaternion RotationFromAxes(const Vec3& x, const Vec3& y, const Vec3& z) {
  const double trace = x.x + y.y + z.z;
  if (trace > 0.0) {
    const double s = 2.0 * std::sqrt(trace + 1.0);
    return Normalized(Quaternion{0.25 * s, (y.z - z.y) / s, (z.x - x.z) / s, (x.y - y.x) / s});
  }
  if (x.x > y.y && x.x > z.z) {
    const double s = 2.0 * std::sqrt(1.0 + x.x - y.y - z.z);
    return Normalized(Quaternion{(y.z - z.y) / s, 0.25 * s, (y.x + x.y) / s, (z.x + x.z) / s});
  }
  if (y.y > z.z) {
    const double s = 2.0 * std::sqrt(1.0 + y.y - x.x - z.z);
    return Normalized(Quaternion{(z.x - x.z) / s, (y.x + x.y) / s, 0.25 * s, (z.y + y.z) / s});
  }
  const double s = 2.0 * std::sqrt(1.0 + z.z - x.x - y.y);
  return Normalized(Quaternion{(x.y - y.x) / s, (z.x + x.z) / s, (z.y + y.z) / s, 0.25 * s});
}

Pose operator*(const Pose& X_a_b, const Pose& X_b_c) {
  return {X_a_b.rotation * X_b_c.rotation, X_a_b * X_b_c.translation};
}

Pose Inverse(const Pose& X_a_b) {
  const Quaternion inverse = Inverse(X_a_b.rotation);
  return {inverse, -Rotate(inverse, X_a_b.translation)};
}

Vec3 operator*(const Pose& X_a_b, const Vec3& p_b) {
  return Rotate(X_a_b.rotation, p_b) + X_a_b.translation;
}

}  // namespace trocar::math
