// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/wall.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/tissue/material.h"

namespace trocar::surgery {

using geometry::EditableMesh;
using geometry::kNone;
using geometry::TriangleKind;

std::vector<tissue::Spring> CalcWallSprings(const geometry::TriangleMesh& mesh,
                                            const WallMaterial& material) {
  const auto edges = geometry::FindEdges(mesh.triangles);
  auto stiffness = tissue::CalcEdgeStiffness(mesh.positions, mesh.triangles, edges,
                                             (1.0 - material.bending_share) * material.membrane_modulus);
  std::vector<tissue::Spring> springs;
  const auto add = [&](std::uint32_t a, std::uint32_t b, double k) {
    const double length = math::Distance(mesh.positions[a], mesh.positions[b]);
    springs.push_back({a, b, k, length / (1.0 + material.prestrain), material.law});
  };
  std::vector<tissue::BendingSpring> across;
  if (material.bending_share > 0.0) {
    across = tissue::CalcBendingSprings(mesh.positions, mesh.triangles,
                                        material.bending_share * material.membrane_modulus);
  }
  for (const tissue::BendingSpring& bending : across) {
    // corners that an edge joins already, around a vertex of three triangles, keep that one spring
    const auto at = std::lower_bound(edges.begin(), edges.end(), geometry::Edge{bending.a, bending.b});
    if (at != edges.end() && *at == geometry::Edge{bending.a, bending.b}) {
      stiffness[static_cast<std::size_t>(at - edges.begin())] += bending.stiffness;
    } else {
      add(bending.a, bending.b, bending.stiffness);
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) add(edges[i][0], edges[i][1], stiffness[i]);
  return springs;
}

namespace {

double CalcArea(const EditableMesh& mesh, std::uint32_t t) {
  return 0.5 * math::Norm(geometry::CalcAreaNormal(mesh.Rest(), mesh.Triangles()[t]));
}

}  // namespace

tissue::Spring CalcWallSpring(const EditableMesh& mesh, std::uint32_t a, std::uint32_t b,
                              const WallMaterial& material) noexcept {
  double edge_area = 0, bending_area = 0;
  const auto is_surface = [&](std::uint32_t t) { return mesh.Kinds()[t] == TriangleKind::kSurface; };
  mesh.ForEachAround(a, [&](std::uint32_t h) {
    const std::uint32_t t = EditableMesh::TriangleOf(h);
    if (mesh.To(h) == b || mesh.Opposite(h) == b)
      edge_area += (is_surface(t) ? 1.0 : kTrenchShare) * CalcArea(mesh, t);
    const std::uint32_t twin = mesh.Twin(EditableMesh::Next(h));
    if (twin == kNone || mesh.Opposite(twin) != b) return;
    const std::uint32_t other = EditableMesh::TriangleOf(twin);
    if (is_surface(t) && is_surface(other)) bending_area += CalcArea(mesh, t) + CalcArea(mesh, other);
  });
  const double squared = math::SquaredDistance(mesh.Rest()[a], mesh.Rest()[b]);
  const double area = (1.0 - material.bending_share) * edge_area + material.bending_share * bending_area;
  return {a, b, area > 0.0 && squared > 0.0 ? material.membrane_modulus * area / squared : 0.0,
          std::sqrt(squared) / (1.0 + material.prestrain), material.law};
}

WallNode CalcWallNode(const EditableMesh& mesh, std::uint32_t v, const WallMaterial& material) noexcept {
  double surface = 0, walls = 0;
  mesh.ForEachAround(v, [&](std::uint32_t h) {
    const std::uint32_t t = EditableMesh::TriangleOf(h);
    (mesh.Kinds()[t] == TriangleKind::kWall ? walls : surface) += CalcArea(mesh, t) / 3.0;
  });
  return {material.mass_by_area * surface, material.foundation * (surface > 0.0 ? surface : walls)};
}

}  // namespace trocar::surgery
