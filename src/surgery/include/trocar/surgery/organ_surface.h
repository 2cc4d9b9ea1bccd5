// SPDX-License-Identifier: Apache-2.0
/// \file organ_surface.h  The part of the tissue that tools can touch: one organ's triangles over the nodes
/// of the whole system.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/core/result.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::surgery {

using math::Vec3;

/// One closed organ inside the system of nodes. Indices in triangles, hierarchy and rows count from
/// first_node.
struct OrganSurface {
  std::uint32_t first_node = 0, node_count = 0;
  std::vector<geometry::Triangle> triangles;
  geometry::Rows vertex_triangles;
  collision::CentroidHierarchy hierarchy;
  geometry::Box box;  ///< of the nodes at the last update [m]

  std::span<const Vec3> Nodes(std::span<const Vec3> positions) const {
    return positions.subspan(first_node, node_count);
  }
};

/// \param positions  (n) of the whole system [m]
/// \param mesh       of the organ; its vertices are the nodes from first_node on
/// \return kMeshInvalid
core::Result<OrganSurface> MakeOrganSurface(std::span<const Vec3> positions, std::uint32_t first_node,
                                            const geometry::TriangleMesh& mesh);

/// Refits hierarchy and box to the nodes.
/// \note Real-time safe.
void UpdateOrganSurface(OrganSurface& surface, std::span<const Vec3> positions) noexcept;

}  // namespace trocar::surgery
