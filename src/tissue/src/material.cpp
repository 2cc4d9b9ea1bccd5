// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/material.h"

#include <algorithm>
#include <cmath>

#include "trocar/core/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::tissue {

std::vector<double> CalcEdgeStiffness(std::span<const Vec3> positions,
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

std::vector<double> CalcFoundationStiffness(std::span<const double> vertex_areas, double modulus,
                                            double depth) {
  TROCAR_ASSERT(modulus >= 0.0 && depth > 0.0);
  std::vector<double> stiffness;
  stiffness.reserve(vertex_areas.size());
  for (const double area : vertex_areas) stiffness.push_back(modulus / depth * area);
  return stiffness;
}

double CalcTubeStiffness(double young_modulus, double radius, double wall_thickness, double length) {
  TROCAR_ASSERT(length > 0.0);
  return young_modulus * 2.0 * M_PI * radius * wall_thickness / length;
}

}  // namespace trocar::tissue
