// SPDX-License-Identifier: Apache-2.0
/// \file link_stiffness.h  Small matrices of springs, shared by cutting and solving.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "trocar/math/vector.h"

namespace trocar::haptics {

using Matrix3 = Eigen::Matrix3d;

inline Eigen::Vector3d ToEigen(const math::Vec3& v) noexcept {
  return {v.x, v.y, v.z};
}
inline math::Vec3 FromEigen(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.y(), v.z()};
}

/// Stiffness of a spring that runs along `along`, isotropic I + axial u u^T. A spring shorter than at rest counts
/// along its direction only, so that sums stay positive definite.
struct LinkStiffness {
  double isotropic = 0;  ///< [N/m]
  double axial = 0;      ///< [N/m]
  math::Vec3 direction;  ///< u
};
inline LinkStiffness CalcLinkStiffness(const math::Vec3& along, double length, double stiffness,
                                       double rest_length) noexcept {
  if (!(length > 0.0)) return {};
  const double across = length > rest_length ? stiffness * (1.0 - rest_length / length) : 0.0;
  return {across, stiffness - across, along / length};
}

/// m += k u u^T
inline void AddAxial(Matrix3& m, const math::Vec3& u, double k) noexcept {
  m(0, 0) += k * u.x * u.x, m(0, 1) += k * u.x * u.y, m(0, 2) += k * u.x * u.z;
  m(1, 0) += k * u.y * u.x, m(1, 1) += k * u.y * u.y, m(1, 2) += k * u.y * u.z;
  m(2, 0) += k * u.z * u.x, m(2, 1) += k * u.z * u.y, m(2, 2) += k * u.z * u.z;
}
inline void AddIsotropic(Matrix3& m, double k) noexcept {
  m(0, 0) += k, m(1, 1) += k, m(2, 2) += k;
}
inline void AddLink(Matrix3& m, const LinkStiffness& link) noexcept {
  AddIsotropic(m, link.isotropic);
  AddAxial(m, link.direction, link.axial);
}

}  // namespace trocar::haptics
