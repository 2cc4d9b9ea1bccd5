// SPDX-License-Identifier: Apache-2.0
/// \file ray_crossing.h  How often a ray along an axis leaves a surface: what says whether a point is inside.
#pragma once

#include <span>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::collision {

/// Which way an edge, seen along a ray from the origin of the plane (u, v), passes the half axis u > 0: +1 upwards, -1
/// downwards, 0 not. Of two triangles that share the edge, one is told the exact opposite of the other.
inline int CountPass(double au, double av, double bu, double bv) noexcept {
  if ((av < 0.0) == (bv < 0.0)) return 0;
  const double turn = au * bv - bu * av;
  if (av < 0.0) return turn > 0.0 ? 1 : 0;
  return turn < 0.0 ? -1 : 0;
}

/// How often the ray from p along an axis leaves through the triangle, less how often it enters.
inline int CountLeaving(std::span<const math::Vec3> positions, const geometry::Triangle& t,
                        const math::Vec3& p, int axis) noexcept {
  const int iu = (axis + 1) % 3, iv = (axis + 2) % 3;
  const math::Vec3 a = positions[t[0]] - p, b = positions[t[1]] - p, c = positions[t[2]] - p;
  if ((a[iv] < 0.0) == (b[iv] < 0.0) && (b[iv] < 0.0) == (c[iv] < 0.0)) return 0;
  const int around = CountPass(a[iu], a[iv], b[iu], b[iv]) + CountPass(b[iu], b[iv], c[iu], c[iv]) +
                     CountPass(c[iu], c[iv], a[iu], a[iv]);
  if (around == 0) return 0;
  // where the axis meets the triangle's plane: before or behind p
  const math::Vec3 normal = math::Cross(b - a, c - a);
  return math::Dot(a, normal) * normal[axis] > 0.0 ? around : 0;
}

/// Majority vote of the rays along x, y and z: true where at least two leave the surface more often than they enter it.
/// \param count_leaving  (axis) -> CountLeaving of all triangles
template <typename Count>
bool DoMostRaysLeave(const Count& count_leaving) noexcept {
  const bool x = count_leaving(0) > 0, y = count_leaving(1) > 0;
  return x == y ? x : count_leaving(2) > 0;
}

}  // namespace trocar::collision
