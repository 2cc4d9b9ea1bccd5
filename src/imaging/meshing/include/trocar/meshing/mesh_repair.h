// SPDX-License-Identifier: Apache-2.0
/// \file mesh_repair.h  Takes away what decimation leaves: slivers, and triangles that cut each other at thin
/// rims.
#pragma once

#include <cstddef>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Criterion and limits of a repair.
struct RepairSettings {
  double min_angle_deg = 8.0;        ///< triangles with a smaller angle are slivers
  std::size_t fewest_triangles = 0;  ///< no edge is collapsed below this count
  int rounds = 12;                   ///< of looking for defects, at most
};

/// Result of a repair: edits that were made, and defects that are left.
struct RepairReport {
  std::size_t flips = 0, collapses = 0, moves = 0;
  std::size_t slivers = 0;             ///< left
  std::size_t self_intersections = 0;  ///< left, as geometry::CountSelfIntersections
};

/// Repairs by local edits: flips of edges, collapses, and moves of single vertices along the surface or,
/// where triangles cut each other, along its normal. For each defect the best edit is taken that makes it
/// smaller and makes none elsewhere; no edit folds the surface or changes its topology, and none adds a
/// triangle. What no edit helps is left and counted.
///
/// \param[in,out] mesh  closed, manifold, outward; stays so. Same input, same bits.
RepairReport RepairMesh(geometry::TriangleMesh& mesh, const RepairSettings& settings = {});

}  // namespace trocar::meshing
