// SPDX-License-Identifier: Apache-2.0
/// \file distance.h  Distances between points, segments and triangles.
#pragma once

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// Point of a triangle that is nearest to a query point.
struct TrianglePoint {
  math::Vec3 point;                           ///< [m]
  std::array<double, 3> weights = {0, 0, 0};  ///< barycentric, >= 0, sum 1
};

/// Nearest point of triangle (a, b, c); slivers and degenerate triangles are segments or points. Weights of
/// corners that do not take part are exactly zero.
/// Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
/// \note Real-time safe.
TrianglePoint FindNearestOnTriangle(const math::Vec3& p, const math::Vec3& a, const math::Vec3& b,
                                    const math::Vec3& c) noexcept;

/// Parameter in [0, 1] of the point of segment a-b that is nearest to p; 0 for a segment without length.
double FindNearestOnSegment(const math::Vec3& p, const math::Vec3& a, const math::Vec3& b) noexcept;

/// Whether two triangles (three corners each) share a point. Coplanar pairs that overlap count.
/// Source: separating-axis theorem over the two normals and the nine (or, in a plane, six) edge directions.
bool TrianglesIntersect(const math::Vec3* a, const math::Vec3* b) noexcept;

/// Whether segment p-q passes through triangle (three corners) from one side to the other. What lies in the
/// triangle's plane, to 1e-7 of its longest side, does not pass.
/// \note Real-time safe.
bool SegmentPiercesTriangle(const math::Vec3& p, const math::Vec3& q, const math::Vec3* triangle) noexcept;

}  // namespace trocar::geometry
