// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/distance.h"

#include <algorithm>

namespace trocar::geometry {

using math::Cross;
using math::Dot;

double FindNearestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 along = b - a;
  const double length2 = Dot(along, along);
  if (!(length2 > 0.0)) return 0.0;
  return std::clamp(Dot(p - a, along) / length2, 0.0, 1.0);
}

TrianglePoint FindNearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const auto result = [&](double u, double v, double w) {
    return TrianglePoint{u * a + v * b + w * c, {u, v, w}};
  };
  const Vec3 ab = b - a, ac = c - a;
  if (!(math::SquaredNorm(Cross(ab, ac)) > 0.0)) {
    // no area: the nearest of the three sides
    const double tab = FindNearestOnSegment(p, a, b), tbc = FindNearestOnSegment(p, b, c), tca = FindNearestOnSegment(p, c, a);
    const TrianglePoint sides[3] = {result(1 - tab, tab, 0), result(0, 1 - tbc, tbc), result(tca, 0, 1 - tca)};
    return *std::min_element(sides, sides + 3, [&](const TrianglePoint& s, const TrianglePoint& t) {
      return math::SquaredDistance(s.point, p) < math::SquaredDistance(t.point, p);
    });
  }

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

}  // namespace trocar::geometry
