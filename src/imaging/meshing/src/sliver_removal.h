// SPDX-License-Identifier: Apache-2.0
/// \file sliver_removal.h  Opens the small angles that no single edit of RepairMesh helps.
/// Source of the idea: Freitag and Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and smoothing", IJNME
/// 1997 (optimisation-based smoothing that alternates with swaps of edges), here for triangles.
#pragma once

#include <cstddef>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Criterion of a sliver, and limits of the removal.
struct SliverSettings {
  double least_angle_deg = 5.0;      ///< triangles with a smaller angle are slivers
  std::size_t fewest_triangles = 0;  ///< no edge is collapsed below this count
  int passes = 20;                   ///< over all slivers that are left, at most
};

/// Triangles with an angle below `least_angle_deg`.
std::size_t CountSlivers(const geometry::TriangleMesh& mesh, double least_angle_deg);

/// Moves the vertices around each sliver together, and flips and collapses edges between, so that the sum of the
/// squared shortfalls of angles below a goal falls with each edit. A neighbour's angle may shrink on the way, which is
/// what RepairMesh does not allow. No edit folds the surface, adds a cut, changes the topology or adds a triangle.
///
/// \param[in,out] mesh  closed, manifold, outward; stays so. A mesh without a sliver keeps its bits; the same input
/// gives the same bits.
/// \return slivers left
std::size_t RemoveSlivers(geometry::TriangleMesh& mesh, const SliverSettings& settings = {});

}  // namespace trocar::meshing
