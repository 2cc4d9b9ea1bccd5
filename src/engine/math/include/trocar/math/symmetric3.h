// SPDX-License-Identifier: Apache-2.0
/// \file symmetric3.h  Symmetric 3 x 3 matrices: xx, xy, xz, yy, yz, zz.
#pragma once

#include <array>

#include "trocar/math/vector.h"

namespace trocar::math {

using Symmetric3 = std::array<double, 6>;

/// m += stiffness u u^T
inline void AddDirection(Symmetric3& m, const Vec3& u, double stiffness) noexcept {
  m[0] += stiffness * u.x * u.x, m[1] += stiffness * u.x * u.y, m[2] += stiffness * u.x * u.z;
  m[3] += stiffness * u.y * u.y, m[4] += stiffness * u.y * u.z, m[5] += stiffness * u.z * u.z;
}

/// m += stiffness I
inline void AddIsotropic(Symmetric3& m, double stiffness) noexcept {
  m[0] += stiffness, m[3] += stiffness, m[5] += stiffness;
}

inline Vec3 Multiply(const Symmetric3& m, const Vec3& v) noexcept {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
          m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

/// Inverse of a positive definite matrix; zero where it is singular, as of a node that nothing holds.
inline Symmetric3 Invert(const Symmetric3& m) noexcept {
  const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5],
               c02 = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
  if (!(determinant > 0.0)) return {};
  const double s = 1.0 / determinant;
  return {s * c00,
          s * c01,
          s * c02,
          s * (m[0] * m[5] - m[2] * m[2]),
          s * (m[1] * m[2] - m[0] * m[4]),
          s * (m[0] * m[3] - m[1] * m[1])};
}

}  // namespace trocar::math
