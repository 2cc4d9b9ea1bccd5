// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/tube.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/cubic_spline.h"
#include "trocar/math/elementary.h"
#include "trocar/math/pose.h"

namespace trocar::geometry {

using math::Vec3;

double CalcLength(const CentreLine& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i)
    length += math::Distance(line.points[i - 1], line.points[i]);
  return length;
}

CentreLine Resample(const CentreLine& line, double spacing) {
  TROCAR_ASSERT(line.points.size() >= 2 && line.radii.size() == line.points.size() && spacing > 0.0);
  const math::CubicSpline spline(line.points, math::SplineEnds::kNatural);
  const int count = std::max(2, 1 + base::RoundTo<int>(spline.Length() / spacing));
  CentreLine resampled;
  std::size_t segment = 0;
  const auto knots = spline.Knots();
  for (int i = 0; i < count; ++i) {
    const double s = spline.Length() * i / (count - 1);
    while (segment + 2 < knots.size() && knots[segment + 1] < s) ++segment;
    const double t = std::clamp((s - knots[segment]) / (knots[segment + 1] - knots[segment]), 0.0, 1.0);
    resampled.points.push_back(spline.Evaluate(s));
    resampled.radii.push_back((1 - t) * line.radii[segment] + t * line.radii[segment + 1]);
  }
  resampled.points.front() = line.points.front();
  resampled.points.back() = line.points.back();
  return resampled;
}

std::vector<Triangle> MakeTubeTriangles(std::size_t point_count, int sides) {
  TROCAR_ASSERT(point_count >= 2 && sides >= 3);
  const auto ring_size = static_cast<std::uint32_t>(sides);
  const auto rings = static_cast<std::uint32_t>(point_count);
  std::vector<Triangle> triangles;
  triangles.reserve(2 * point_count * ring_size);
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t side = 0; side < ring_size; ++side) {
      const std::uint32_t next = (side + 1) % ring_size, low = ring * ring_size, high = low + ring_size;
      triangles.push_back({low + side, low + next, high + next});
      triangles.push_back({low + side, high + next, high + side});
    }
  }
  const std::uint32_t first_centre = rings * ring_size, last_ring = (rings - 1) * ring_size;
  for (std::uint32_t side = 0; side < ring_size; ++side) {
    const std::uint32_t next = (side + 1) % ring_size;
    triangles.push_back({first_centre, next, side});
    triangles.push_back({first_centre + 1, last_ring + side, last_ring + next});
  }
  return triangles;
}

void CalcTubeSkin(std::span<const Vec3> points, std::span<const double> radii, int sides,
                  std::span<Vec3> skin) noexcept {
  const std::size_t n = points.size();
  TROCAR_ASSERT(radii.size() == n && skin.size() == n * static_cast<std::size_t>(sides) + 2);
  Vec3 tangent = math::Normalized(points[1] - points[0]);
  Vec3 across = math::AnyPerpendicular(tangent);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 along = i == 0       ? points[1] - points[0]
                       : i + 1 == n ? points[n - 1] - points[n - 2]
                                    : points[i + 1] - points[i - 1];
    const Vec3 next_tangent = math::Normalized(along, tangent);
    across = math::Rotate(math::RotationBetween(tangent, next_tangent), across);
    across = math::Normalized(across - math::Dot(across, next_tangent) * next_tangent,
                              math::AnyPerpendicular(next_tangent));
    tangent = next_tangent;
    const Vec3 up = math::Cross(tangent, across);
    for (int side = 0; side < sides; ++side) {
      const double angle = 2.0 * M_PI * side / sides;
      skin[i * static_cast<std::size_t>(sides) + static_cast<std::size_t>(side)] =
          points[i] + radii[i] * (math::Cos(angle) * across + math::Sin(angle) * up);
    }
  }
  skin[n * static_cast<std::size_t>(sides)] = points[0];
  skin[n * static_cast<std::size_t>(sides) + 1] = points[n - 1];
}

TriangleMesh MakeTube(const CentreLine& line, int sides) {
  TriangleMesh mesh;
  mesh.triangles = MakeTubeTriangles(line.points.size(), sides);
  mesh.positions.resize(line.points.size() * static_cast<std::size_t>(sides) + 2);
  CalcTubeSkin(line.points, line.radii, sides, mesh.positions);
  return mesh;
}

}  // namespace trocar::geometry
