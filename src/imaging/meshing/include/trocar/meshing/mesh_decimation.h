// SPDX-License-Identifier: Apache-2.0
/// \file mesh_decimation.h  Fewer triangles of good shape: springs live on their edges.
/// Source: Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997; link
/// condition: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999; relaxation:
/// Botsch and Kobbelt, "A remeshing approach to multiresolution modeling", SGP 2004. The bulk is done by
/// meshoptimizer.
#pragma once

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// How the triangles are reduced and shaped.
struct DecimationSettings {
  int triangle_budget = 1000;  ///< at most this many triangles, at least 98 % of it; >= 8
  int relaxation_rounds = 12;  ///< rounds of edge flips and tangential relaxation on the original surface
  double bulk_factor =
      4.0;  ///< meshoptimizer reduces to this many times the budget, collapses of ours finish
};

/// Closed, manifold, outward mesh with the same volume and topology and at most the budget of triangles.
///
/// \param mesh  closed, manifold, outward; a mesh within the budget is only relaxed
/// \return kMeshNotClosed when the input is not closed and manifold, or cannot be reduced to the budget
base::Result<geometry::TriangleMesh> DecimateMesh(const geometry::TriangleMesh& mesh,
                                                  const DecimationSettings& settings);

}  // namespace trocar::meshing
