// SPDX-License-Identifier: Apache-2.0
/// \file triangle_distance.h  Distance from a segment to one triangle.
#pragma once

#include "trocar/geometry/distance.h"

namespace trocar::collision {

/// Nearest points of a segment and a triangle.
struct SegmentTrianglePoints {
  double parameter = 0;                 ///< along the segment, 0 at its start, 1 at its end
  math::Vec3 on_segment;                ///< [m]
  geometry::TrianglePoint on_triangle;  ///< [m]
  double squared_distance = 0;          ///< [m^2]; exactly 0 where the segment pierces the triangle
};

/// Nearest points of segment start-end and triangle (a, b, c); either may be degenerate.
///
/// A segment that does not pierce the triangle is nearest at one of its ends or beside one of the triangle's
/// sides.
/// Source: Ericson, "Real-Time Collision Detection", 2005, sections 5.1.9, 5.1.10 and 5.3.6.
/// \note Real-time safe: no allocation, lock or throw.
SegmentTrianglePoints FindNearestSegmentTriangle(const math::Vec3& start, const math::Vec3& end,
                                                 const math::Vec3& a, const math::Vec3& b,
                                                 const math::Vec3& c) noexcept;

}  // namespace trocar::collision
