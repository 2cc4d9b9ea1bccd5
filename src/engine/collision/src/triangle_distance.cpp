// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/triangle_distance.h"

#include <algorithm>
#include <cmath>

#include "trocar/collision/segment_distance.h"

namespace trocar::collision {

using geometry::TrianglePoint;
using math::Cross;
using math::Dot;
using math::SquaredDistance;
using math::SquaredNorm;
using math::Vec3;

namespace {

// (gap / size)^2 up to which the points of a segment and a triangle are the same point [-]
constexpr double kPierceGap2 = 1e-24;

/// Corner weights of a point on side `side` (from corner `side` to the next) at parameter t.
TrianglePoint PointOnSide(const Vec3* corners, int side, double t) {
  const int next = (side + 1) % 3;
  TrianglePoint result;
  result.weights[side] = 1.0 - t;
  result.weights[next] = t;
  result.point = t <= 0.0   ? corners[side]
                 : t >= 1.0 ? corners[next]
                            : (1.0 - t) * corners[side] + t * corners[next];
  return result;
}

}  // namespace

SegmentTrianglePoints FindNearestSegmentTriangle(const Vec3& start, const Vec3& end, const Vec3& a,
                                                 const Vec3& b, const Vec3& c) noexcept {
  const Vec3 along = end - start;
  const Vec3 corners[3] = {a, b, c};
  const auto at = [&](double t) { return t >= 1.0 ? end : start + t * along; };

  // does it pierce the triangle? (Ericson 2005, section 5.3.6, both directions) On slivers the formula may
  // answer with a point of its own making, so the two points that it names must coincide.
  const Vec3 ab = b - a, ac = c - a, normal = Cross(ab, ac);
  const double slope = -Dot(along, normal);
  if (slope != 0.0) {
    const double t = Dot(start - a, normal) / slope;
    const Vec3 moment = Cross(-along, start - a);
    const double v = Dot(ac, moment) / slope, w = -Dot(ab, moment) / slope;
    if (t >= 0.0 && t <= 1.0 && v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
      const Vec3 on_segment = at(t), on_triangle = a + v * ab + w * ac;
      const double size2 = SquaredNorm(along) + SquaredNorm(ab) + SquaredNorm(ac);
      if (SquaredDistance(on_segment, on_triangle) <= kPierceGap2 * size2) {
        return {t, on_segment, {on_segment, {1.0 - v - w, v, w}}, 0.0};
      }
    }
  }

  // the ends against the triangle, then the sides and corners against the segment
  SegmentTrianglePoints best;
  best.on_segment = start;
  best.on_triangle = geometry::FindNearestOnTriangle(start, a, b, c);
  best.squared_distance = SquaredDistance(start, best.on_triangle.point);
  const auto consider = [&](double parameter, const TrianglePoint& on_triangle) {
    const Vec3 on_segment = at(parameter);
    const double d2 = SquaredDistance(on_segment, on_triangle.point);
    if (d2 < best.squared_distance) best = {parameter, on_segment, on_triangle, d2};
  };
  consider(1.0, geometry::FindNearestOnTriangle(end, a, b, c));
  for (int side = 0; side < 3; ++side) {
    double s = 0.0, t = 0.0;
    FindNearestParameters(start, end, corners[side], corners[(side + 1) % 3], s, t);
    consider(s, PointOnSide(corners, side, t));
    // near-parallel sides lose the digits of s; then a corner is as near
    consider(geometry::FindNearestOnSegment(corners[side], start, end), PointOnSide(corners, side, 0.0));
  }
  return best;
}

}  // namespace trocar::collision
