// SPDX-License-Identifier: Apache-2.0
/// \file organ_surface.h  The part of the tissue that tools can touch: organs' triangles and the pieces of ducts
/// and vessels, over the nodes of the whole system.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/collision/capsule_tree.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::surgery {

/// One closed organ inside the system of nodes. Indices in triangles, tree and rows count from
/// first_node.
struct OrganSurface {
  std::uint32_t first_node = 0, node_count = 0;
  std::vector<geometry::Triangle> triangles;
  geometry::Rows vertex_triangles;
  std::vector<double> vertex_areas;  ///< (node_count) at rest [m^2]
  collision::TriangleTree tree;
  geometry::Box box;                       ///< of the nodes at the last update [m]
  std::vector<math::Vec3> last_positions;  ///< (node_count) at the last update [m]
  double travel = 0;  ///< sum over all updates of how far the node that moved most has gone [m]
  /// Pinch that damages: of the smallest bite, and of one that fills the jaws [N].
  /// Source: domain facts, section 3.3 (Heijnsdijk 2004: 15 to 37 N as the contact area grows).
  double damage_pinch_small = 15.0, damage_pinch_full = 37.0;

  std::span<const math::Vec3> Nodes(std::span<const math::Vec3> positions) const {
    return positions.subspan(first_node, node_count);
  }
};

/// \param positions  (n) of the whole system [m]
/// \param mesh       of the organ; its vertices are the nodes from first_node on
/// \return kMeshInvalid
base::Result<OrganSurface> MakeOrganSurface(std::span<const math::Vec3> positions, std::uint32_t first_node,
                                            const geometry::TriangleMesh& mesh);

/// Refits tree and box to the nodes, and adds to the travel.
/// \note Real-time safe.
void UpdateOrganSurface(OrganSurface& surface, std::span<const math::Vec3> positions) noexcept;

/// One duct or vessel as a chain of capsules between its centre-line nodes.
struct TubeSurface {
  std::uint32_t first_node = 0, node_count = 0;  ///< node_count >= 2
  std::vector<double> radii;                     ///< (node_count) [m]
};

/// All ducts and vessels of the system.
struct TubeSet {
  std::vector<TubeSurface> tubes;
  std::vector<std::uint32_t> tube_of_piece;  ///< (pieces) index into tubes
  collision::CapsuleTree tree;               ///< pieces over the nodes of the whole system
};

/// \param positions  (n) of the whole system [m]
/// \param tubes      may be empty
/// \return kMeshInvalid
base::Result<TubeSet> MakeTubeSet(std::span<const math::Vec3> positions, std::vector<TubeSurface> tubes);

}  // namespace trocar::surgery
