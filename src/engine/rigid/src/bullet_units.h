// SPDX-License-Identifier: Apache-2.0
/// \file bullet_units.h  Between metres and the centimetres in which Bullet counts. Private: only the rigid_*.cpp see Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include "trocar/math/pose.h"

namespace trocar::rigid {

// Bullet's tolerances are made for things of a size of one: it counts in centimetres
inline constexpr double kScale = 100.0;
inline constexpr double kMargin = 0.01;  // of shapes [cm]

inline btVector3 ToBullet(const math::Vec3& v) {
  return {v.x * kScale, v.y * kScale, v.z * kScale};
}
inline math::Vec3 FromBullet(const btVector3& v) {
  return {v.x() / kScale, v.y() / kScale, v.z() / kScale};
}
inline btTransform ToBullet(const math::Pose& X) {
  return btTransform(btQuaternion(X.rotation.x, X.rotation.y, X.rotation.z, X.rotation.w),
                     ToBullet(X.translation));
}
inline math::Pose FromBullet(const btTransform& X) {
  const btQuaternion q = X.getRotation();
  return {math::Quaternion{q.w(), q.x(), q.y(), q.z()}, FromBullet(X.getOrigin())};
}

}  // namespace trocar::rigid
