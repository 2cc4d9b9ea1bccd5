// SPDX-License-Identifier: Apache-2.0
/// \file link_stiffness.h  Small matrices of springs.
#pragma once

#include <Eigen/Dense>

#include "trocar/math/vector.h"
#include "trocar/tissue/link_stiffness.h"

namespace trocar::haptics {

using Matrix3 = Eigen::Matrix3d;

inline Eigen::Vector3d ToEigen(const math::Vec3& v) noexcept {
  return {v.x, v.y, v.z};
}
inline math::Vec3 FromEigen(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.y(), v.z()};
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
inline void AddLink(Matrix3& m, const tissue::LinkStiffness& link) noexcept {
  AddIsotropic(m, link.isotropic);
  AddAxial(m, link.direction, link.axial);
}

}  // namespace trocar::haptics
