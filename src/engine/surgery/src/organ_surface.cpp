// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::surgery {

using math::Vec3;

base::Result<OrganSurface> MakeOrganSurface(std::span<const Vec3> positions, std::uint32_t first_node,
                                            const geometry::TriangleMesh& mesh) {
  TROCAR_ASSERT(first_node + mesh.positions.size() <= positions.size());
  OrganSurface surface;
  surface.first_node = first_node;
  surface.node_count = static_cast<std::uint32_t>(mesh.positions.size());
  surface.triangles = mesh.triangles;
  surface.vertex_triangles = geometry::FindVertexTriangles(mesh.triangles, mesh.positions.size());
  surface.vertex_areas = geometry::CalcVertexAreas(surface.Nodes(positions), mesh.triangles);
  auto tree = collision::TriangleTree::Make(surface.Nodes(positions), surface.triangles);
  if (!tree.ok()) return tree.error();
  surface.tree = std::move(*tree);
  const auto nodes = surface.Nodes(positions);
  surface.last_positions.assign(nodes.begin(), nodes.end());
  UpdateOrganSurface(surface, positions);
  return surface;
}

void UpdateOrganSurface(OrganSurface& surface, std::span<const Vec3> positions) noexcept {
  const auto nodes = surface.Nodes(positions);
  surface.tree.Update(nodes);
  surface.box = geometry::CalcBox(nodes);
  double longest2 = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    longest2 = std::max(longest2, math::SquaredDistance(nodes[i], surface.last_positions[i]));
    surface.last_positions[i] = nodes[i];
  }
  surface.travel += std::sqrt(longest2);
}

base::Result<TubeSet> MakeTubeSet(std::span<const Vec3> positions, std::vector<TubeSurface> tubes) {
  TubeSet made;
  std::vector<collision::TubePiece> pieces;
  for (std::uint32_t tube = 0; tube < tubes.size(); ++tube) {
    const TubeSurface& surface = tubes[tube];
    TROCAR_ASSERT(surface.radii.size() == surface.node_count);
    for (std::uint32_t i = 0; i + 1 < surface.node_count; ++i) {
      const std::uint32_t node = surface.first_node + i;
      pieces.push_back({node, node + 1, std::max(surface.radii[i], surface.radii[i + 1])});
      made.tube_of_piece.push_back(tube);
    }
  }
  auto tree = collision::CapsuleTree::Make(positions, pieces);
  if (!tree.ok()) return tree.error();
  made.tree = std::move(*tree);
  made.tubes = std::move(tubes);
  return made;
}

}  // namespace trocar::surgery
