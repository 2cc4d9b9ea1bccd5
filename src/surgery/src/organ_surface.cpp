// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_surface.h"

#include <utility>

#include "trocar/core/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::surgery {

core::Result<OrganSurface> MakeOrganSurface(std::span<const Vec3> positions, std::uint32_t first_node,
                                            const geometry::TriangleMesh& mesh) {
  TROCAR_ASSERT(first_node + mesh.positions.size() <= positions.size());
  OrganSurface surface;
  surface.first_node = first_node;
  surface.node_count = static_cast<std::uint32_t>(mesh.positions.size());
  surface.triangles = mesh.triangles;
  surface.vertex_triangles = geometry::FindVertexTriangles(mesh.triangles, mesh.positions.size());
  auto hierarchy = collision::CentroidHierarchy::Make(surface.Nodes(positions), surface.triangles);
  if (!hierarchy.ok()) return hierarchy.error();
  surface.hierarchy = std::move(*hierarchy);
  UpdateOrganSurface(surface, positions);
  return surface;
}

void UpdateOrganSurface(OrganSurface& surface, std::span<const Vec3> positions) noexcept {
  surface.hierarchy.UpdateAll(surface.Nodes(positions));
  surface.box = geometry::CalcBox(surface.Nodes(positions));
}

}  // namespace trocar::surgery
