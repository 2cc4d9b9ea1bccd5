// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/background.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/omentum.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/noise.h"

namespace trocar::render {
namespace {

using geometry::TriangleMesh;
using math::Vec3;
using roles::NeighbourRole;

// Wall: an ellipsoid through the usual port sites (domain facts, section 1.3), so that tools come out of it
// there.
constexpr Vec3 kWallCentre{-0.010, 0.050, -0.100};
constexpr Vec3 kWallAxes{0.180, 0.235, 0.104};
constexpr double kWallMargin = 0.006;      // m between an organ and the wall
constexpr double kWallNearCosine = 0.978;  // about 12 degrees: how far an organ pushes the wall out sideways

TriangleMesh MakeWall(std::span<const Vec3> inside) {
  TriangleMesh wall = geometry::MakeSphere({0, 0, 0}, 1.0, 4);
  std::vector<double> radii(wall.positions.size());
  std::vector<double> needed(wall.positions.size(), 0.0);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const Vec3 d = wall.positions[i];
    const Vec3 scaled{d.x / kWallAxes.x, d.y / kWallAxes.y, d.z / kWallAxes.z};
    radii[i] = 1.0 / math::Norm(scaled);
    for (const Vec3& p : inside) {
      const Vec3 to = p - kWallCentre;
      const double distance = math::Norm(to);
      if (math::Dot(to, d) > kWallNearCosine * distance)
        needed[i] = std::max(needed[i], distance + kWallMargin);
    }
    radii[i] = std::max(radii[i], needed[i]);
  }
  // smooth the steps that the organs pressed into it
  const geometry::Rows neighbours = geometry::FindVertexNeighbours(wall.triangles, radii.size());
  for (int round = 0; round < 12; ++round) {
    std::vector<double> smooth = radii;
    for (std::size_t i = 0; i < radii.size(); ++i) {
      double sum = 0;
      for (const std::uint32_t j : neighbours.Row(i)) sum += radii[j];
      smooth[i] =
          std::max(needed[i], 0.5 * radii[i] + 0.5 * sum / static_cast<double>(neighbours.Row(i).size()));
    }
    radii = std::move(smooth);
  }
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const Vec3 d = wall.positions[i];
    // shallow folds, outwards only
    const double fold = 0.003 * (1.0 + math::CalcGradientNoise(5.0 * d, 0));
    wall.positions[i] = kWallCentre + (radii[i] + fold) * d;
  }
  for (auto& triangle : wall.triangles) std::swap(triangle[1], triangle[2]);
  return wall;
}

/// Bowel: a tube with bulges (haustra) `pitch` apart.
TriangleMesh MakeBowel(std::vector<Vec3> points, double radius, double pitch, double depth) {
  geometry::CentreLine line{std::move(points), {}};
  line.radii.assign(line.points.size(), radius);
  line = geometry::Resample(line, 0.004);
  double along = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    if (i > 0) along += math::Distance(line.points[i], line.points[i - 1]);
    const double wave = std::fabs(std::sin(M_PI * along / pitch));
    line.radii[i] = radius * (1.0 - depth + depth * std::sqrt(wave) +
                              0.08 * math::CalcGradientNoise(30.0 * line.points[i], 0));
  }
  return geometry::MakeTube(line, 28);
}

TriangleMesh MakeStomach() {
  TriangleMesh stomach = geometry::MakeSphere({0, 0, 0}, 1.0, 4);
  for (Vec3& p : stomach.positions) {
    const double swell =
        1.0 + 0.10 * math::CalcGradientNoise(1.7 * p, 0) + 0.02 * math::CalcGradientNoise(6.0 * p, 0);
    p = Vec3{0.085, 0.085, -0.150} + swell * Vec3{0.062 * p.x, 0.045 * p.y, 0.040 * p.z};
  }
  return stomach;
}

}  // namespace

std::vector<BackgroundPart> MakeAbdomen(std::span<const Vec3> inside, std::span<const Obstacle> above,
                                        std::span<const NeighbourRole> without) {
  const auto is_wanted = [&](NeighbourRole role) {
    return std::find(without.begin(), without.end(), role) == without.end();
  };
  std::vector<BackgroundPart> parts;
  if (is_wanted(NeighbourRole::kColon)) {
    parts.push_back({NameOf(NeighbourRole::kColon), Material::kBowel,
                     MakeBowel({{-0.150, -0.030, -0.130},
                                {-0.115, 0.010, -0.125},
                                {-0.055, -0.005, -0.118},
                                {0.000, -0.015, -0.112},
                                {0.060, -0.005, -0.115},
                                {0.120, 0.030, -0.130}},
                               0.021, 0.026, 0.22)});
  }
  if (is_wanted(NeighbourRole::kStomach))
    parts.push_back({NameOf(NeighbourRole::kStomach), Material::kBowel, MakeStomach()});
  parts.push_back({"omentum", Material::kFat, geometry::MakeOmentum(above)});
  parts.push_back({"wall", Material::kPeritoneum, MakeWall(inside)});
  return parts;
}

}  // namespace trocar::render
