// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/figure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trocar::render {
namespace {

using math::Vec3;

/// Distance along the ray to a triangle that faces it; negative for none.
/// Source: Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 1997.
double CalcHit(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 p = Cross(ray.direction, ac);
  const double determinant = Dot(ab, p);
  if (determinant <= 0) return -1;
  const Vec3 from = ray.origin - a;
  const double u = Dot(from, p);
  if (u < 0 || u > determinant) return -1;
  const Vec3 q = Cross(from, ab);
  const double v = Dot(ray.direction, q);
  if (v < 0 || u + v > determinant) return -1;
  return Dot(ac, q) / determinant;
}

}  // namespace

geometry::Box CalcFigureBox(std::span<const FigureSurface> surfaces, const FigureMarks& marks) {
  constexpr double kFar = std::numeric_limits<double>::max();
  geometry::Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto take_in = [&box](const Vec3& p) {
    if (!math::IsFinite(p)) return;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = std::min(box.min[axis], p[axis]);
      box.max[axis] = std::max(box.max[axis], p[axis]);
    }
  };
  for (const FigureSurface& surface : surfaces)
    std::for_each(surface.positions.begin(), surface.positions.end(), take_in);
  for (const FigureLine& line : marks.lines) std::for_each(line.points.begin(), line.points.end(), take_in);
  for (const FigurePoint& point : marks.points) take_in(point.position);
  constexpr double kHalf = 0.05;
  if (box.min.x > box.max.x) return {{-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, kHalf}};
  return box;
}

std::optional<SurfaceHit> PickSurface(std::span<const FigureSurface> surfaces, const Ray& ray) {
  std::optional<SurfaceHit> hit;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const FigureSurface& surface = surfaces[s];
    if (!surface.is_pickable) continue;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& triangle = surface.triangles[t];
      const double distance = CalcHit(ray, surface.positions[triangle[0]], surface.positions[triangle[1]],
                                      surface.positions[triangle[2]]);
      if (distance <= 0 || (hit && distance >= hit->distance)) continue;
      hit = SurfaceHit{s, t, triangle[0], ray.origin + distance * ray.direction, distance};
    }
  }
  if (!hit) return hit;
  const FigureSurface& surface = surfaces[hit->surface];
  for (const auto vertex : surface.triangles[hit->triangle]) {
    if (Distance(surface.positions[vertex], hit->point) <
        Distance(surface.positions[hit->vertex], hit->point))
      hit->vertex = vertex;
  }
  return hit;
}

std::optional<std::size_t> PickPoint(std::span<const FigurePoint> points, const OrbitCamera& camera, double x,
                                     double y, int width, int height, double reach) {
  std::optional<std::size_t> best;
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const math::Vec2 at = CalcPixel(camera, points[i].position, width, height);
    const double away = std::hypot(at.x - x, at.y - y);
    // a point behind the lens is not finite and never nearer
    if (away <= 0.5 * points[i].diameter + reach && away < nearest) nearest = away, best = i;
  }
  return best;
}

}  // namespace trocar::render
