// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/material.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::tissue {

std::vector<double> CalcEdgeStiffness(std::span<const math::Vec3> positions,
                                      std::span<const geometry::Triangle> triangles,
                                      std::span<const geometry::Edge> edges, double membrane_modulus) {
  TROCAR_ASSERT(membrane_modulus >= 0.0);
  std::vector<double> stiffness(edges.size(), 0.0);
  for (const geometry::Triangle& t : triangles) {
    const double area = 0.5 * math::Norm(geometry::CalcAreaNormal(positions, t));
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
      const geometry::Edge edge{low, high};
      const auto at = std::lower_bound(edges.begin(), edges.end(), edge);
      TROCAR_ASSERT(at != edges.end() && *at == edge);
      stiffness[static_cast<std::size_t>(at - edges.begin())] +=
          membrane_modulus * area / math::SquaredDistance(positions[low], positions[high]);
    }
  }
  return stiffness;
}

std::vector<BendingSpring> CalcBendingSprings(std::span<const math::Vec3> positions,
                                              std::span<const geometry::Triangle> triangles,
                                              double membrane_modulus) {
  TROCAR_ASSERT(membrane_modulus >= 0.0);
  // each inner edge is met from both of its sides; sorted, the two stand together
  struct Side {
    geometry::Edge edge;
    std::uint32_t corner;
    double area;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const geometry::Triangle& t : triangles) {
    const double area = 0.5 * math::Norm(geometry::CalcAreaNormal(positions, t));
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
      sides.push_back({{low, high}, t[(i + 2) % 3], area});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.corner < b.corner;
  });
  std::vector<BendingSpring> springs;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &one = sides[i], &other = sides[i + 1];
    if (one.edge != other.edge || one.corner == other.corner) continue;
    const double length2 = math::SquaredDistance(positions[one.corner], positions[other.corner]);
    if (!(length2 > 0.0)) continue;
    springs.push_back({one.corner, other.corner, membrane_modulus * (one.area + other.area) / length2});
  }
  std::stable_sort(springs.begin(), springs.end(), [](const BendingSpring& a, const BendingSpring& b) {
    return a.a != b.a ? a.a < b.a : a.b < b.b;
  });
  // corners that face each other across two edges, or along an edge of their own, share one spring of the sum
  std::size_t kept = 0;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    if (kept > 0 && springs[kept - 1].a == springs[i].a && springs[kept - 1].b == springs[i].b) {
      springs[kept - 1].stiffness += springs[i].stiffness;
    } else {
      springs[kept++] = springs[i];
    }
  }
  springs.resize(kept);
  return springs;
}

double CalcBendingShare(double thickness, double height) {
  TROCAR_ASSERT(thickness >= 0.0 && height > 0.0);
  // three quarters: edges and bending springs of the equilateral lattice are equally stiff then
  constexpr double kMostBending = 0.75;
  constexpr double kPoisson = 1.0 / 3.0, kRightAngle = 0.5 * M_PI;
  const double ratio = thickness / height;
  return std::min(kMostBending,
                  16.0 / 3.0 / (1.0 - kPoisson * kPoisson) / (kRightAngle * kRightAngle) * ratio * ratio);
}

std::vector<double> CalcFoundationStiffness(std::span<const double> vertex_areas, double modulus,
                                            double depth) {
  TROCAR_ASSERT(modulus >= 0.0 && depth > 0.0);
  std::vector<double> stiffness;
  stiffness.reserve(vertex_areas.size());
  for (const double area : vertex_areas) stiffness.push_back(modulus / depth * area);
  return stiffness;
}

double CalcPunchStiffness(double young_modulus, double poisson_ratio, double radius) {
  return 2.0 * radius * young_modulus / (1.0 - poisson_ratio * poisson_ratio);
}

double CalcTubeStiffness(double young_modulus, double radius, double wall_thickness, double length) {
  TROCAR_ASSERT(length > 0.0);
  return young_modulus * 2.0 * M_PI * radius * wall_thickness / length;
}

}  // namespace trocar::tissue
