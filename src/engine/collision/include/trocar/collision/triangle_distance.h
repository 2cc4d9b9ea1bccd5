// SPDX-License-Identifier: Apache-2.0
/// \file triangle_distance.h  Distance from a segment to one triangle.
#pragma once

#include "trocar/geometry/distance.h"

namespace trocar::collision {

using geometry::TrianglePoint;
using math::Vec3;

/// Nearest points of a segment and a triangle.
struct SegmentTrianglePoints {
  double parameter = 0;         ///< along the segment, 0 at its start, 1 at its end
  Vec3 on_segment;              ///< [m]
  TrianglePoint on_triangle;    ///< [m]
  double squared_distance = 0;  ///< [m^2]; exactly 0 where the segment pierces the triangle
};

/// Nearest points of segment start-end and triangle (a, b, c); either may be degenerate.
///
/// A segment that does not pierce the triangle is nearest at one of its ends or beside one of the triangle's
/// sides.
/// Source: Ericson, "Real-Time Collision Detection", 2005, sections 5.1.9, 5.1.10 and 5.3.6.
/// \note Real-time safe: no allocation, lock or throw.
SegmentTrianglePoints FindNearestSegmentTriangle(const Vec3& start, const Vec3& end, const Vec3& a,
                                                 const Vec3& b, const Vec3& c) noexcept;

}  // namespace trocar::collision
