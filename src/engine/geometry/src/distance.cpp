// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace trocar::geometry {

using math::Cross;
using math::Dot;
using math::Vec3;

double FindNearestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 along = b - a;
  const double length2 = Dot(along, along);
  if (!(length2 > 0.0)) return 0.0;
  return std::clamp(Dot(p - a, along) / length2, 0.0, 1.0);
}

namespace {

/// (twice the area / longest side squared)^2 below which the region tests are not trusted [-].
constexpr double kSliver2 = 1e-8;

/// Ericson's region tests; they lose their digits on slivers.
TrianglePoint FindByRegions(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const auto result = [&](double u, double v, double w) {
    return TrianglePoint{u * a + v * b + w * c, {u, v, w}};
  };
  const Vec3 ab = b - a, ac = c - a;
  // regions of the corners and sides in turn
  const Vec3 ap = p - a;
  const double d1 = Dot(ab, ap), d2 = Dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return result(1, 0, 0);
  const Vec3 bp = p - b;
  const double d3 = Dot(ab, bp), d4 = Dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return result(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return result(1 - v, v, 0);
  }
  const Vec3 cp = p - c;
  const double d5 = Dot(ab, cp), d6 = Dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return result(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return result(1 - w, 0, w);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return result(0, 1 - w, w);
  }
  const double v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  return result(1 - v - w, v, w);
}

/// Nearest point of the three sides.
TrianglePoint FindOnSides(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 corners[3] = {a, b, c};
  TrianglePoint best;
  for (int side = 0; side < 3; ++side) {
    const int next = (side + 1) % 3;
    const double t = FindNearestOnSegment(p, corners[side], corners[next]);
    TrianglePoint candidate{math::Lerp(corners[side], corners[next], t), {}};
    if (t >= 1.0) candidate.point = corners[next];
    candidate.weights[side] = 1.0 - t;
    candidate.weights[next] = t;
    if (side == 0 || math::SquaredDistance(candidate.point, p) < math::SquaredDistance(best.point, p))
      best = candidate;
  }
  return best;
}

}  // namespace

TrianglePoint FindNearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 ab = b - a, ac = c - a;
  const double longest2 =
      std::max({math::SquaredNorm(ab), math::SquaredNorm(ac), math::SquaredDistance(b, c)});
  const TrianglePoint plain = FindByRegions(p, a, b, c);
  if (math::SquaredNorm(Cross(ab, ac)) > kSliver2 * longest2 * longest2) return plain;

  // a sliver: the plain answer counts only if it is a point of the triangle, and only if no side is nearer
  const TrianglePoint on_sides = FindOnSides(p, a, b, c);
  const bool is_inside =
      std::all_of(plain.weights.begin(), plain.weights.end(), [](double w) { return w >= 0.0 && w <= 1.0; });
  const bool is_nearer = math::SquaredDistance(plain.point, p) < math::SquaredDistance(on_sides.point, p);
  return is_inside && is_nearer ? plain : on_sides;
}

bool TrianglesIntersect(const Vec3* a, const Vec3* b) noexcept {
  const Vec3 ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const Vec3 eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vec3 na = Cross(ea[0], ea[1]), nb = Cross(eb[0], eb[1]);
  const auto separates = [&](const Vec3& axis) {
    if (!(math::SquaredNorm(axis) > 0.0)) return false;
    const auto [a_low, a_high] = std::minmax({Dot(a[0], axis), Dot(a[1], axis), Dot(a[2], axis)});
    const auto [b_low, b_high] = std::minmax({Dot(b[0], axis), Dot(b[1], axis), Dot(b[2], axis)});
    return a_high < b_low || b_high < a_low;
  };
  if (separates(na) || separates(nb)) return false;
  for (const Vec3& side_a : ea) {
    if (separates(Cross(na, side_a))) return false;
    for (const Vec3& side_b : eb) {
      if (separates(Cross(side_a, side_b))) return false;
    }
  }
  for (const Vec3& side_b : eb) {
    if (separates(Cross(nb, side_b))) return false;
  }
  return true;
}

bool SegmentPiercesTriangle(const Vec3& p, const Vec3& q, const Vec3* triangle) noexcept {
  constexpr double kInPlane = 1e-7;  // of the longest side
  const Vec3 &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const Vec3 normal = Cross(b - a, c - a);
  const double longest = std::sqrt(
      std::max({math::SquaredDistance(a, b), math::SquaredDistance(b, c), math::SquaredDistance(c, a)}));
  const double in_plane = kInPlane * longest * math::Norm(normal);
  const double from = Dot(normal, p - a), to = Dot(normal, q - a);
  if (!(std::fabs(from) > in_plane && std::fabs(to) > in_plane) || (from > 0) == (to > 0)) return false;
  // the line runs on the same side of all three sides
  const Vec3 along = q - p;
  const double u = Dot(along, Cross(a - p, b - p)), v = Dot(along, Cross(b - p, c - p)),
               w = Dot(along, Cross(c - p, a - p));
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

}  // namespace trocar::geometry
