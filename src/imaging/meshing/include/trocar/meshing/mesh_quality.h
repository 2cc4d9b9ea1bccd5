// SPDX-License-Identifier: Apache-2.0
/// \file mesh_quality.h  How good a mesh is, by itself and as a picture of the surface that it was made from.
#pragma once

#include <cstddef>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Distances between two surfaces, sampled both ways [unit of the meshes].
struct SurfaceDistance {
  double largest_from_mesh = 0, mean_from_mesh = 0;            ///< from the mesh to the reference
  double largest_from_reference = 0, mean_from_reference = 0;  ///< and back
  std::size_t mesh_samples = 0, reference_samples = 0;

  /// Two-sided Hausdorff distance of the samples: never larger than the true one.
  double Hausdorff() const {
    return largest_from_mesh > largest_from_reference ? largest_from_mesh : largest_from_reference;
  }
};

/// Distances of samples of either surface to the nearest point of the other.
///
/// The mesh is sampled at its vertices and evenly over its area, the reference at its vertices, every n-th of
/// them where there are more than asked for.
/// \param samples  each way, about; > 0
/// \pre both have triangles (TROCAR_ASSERT)
SurfaceDistance CalcSurfaceDistance(const geometry::TriangleMesh& mesh,
                                    const geometry::TriangleMesh& reference, std::size_t samples);

/// Quality of a mesh that was made from a volume. Lengths and volumes are in the mesh's unit.
struct MeshQuality {
  geometry::MeshReport surface;        ///< closed, manifold, outward, genus, angles, volume
  std::size_t self_intersections = 0;  ///< pairs of triangles
  double volume_change = 0;            ///< against the reference, as a share of it [-]
  SurfaceDistance distance;            ///< to the reference; all zero where it was not measured

  /// Closed, manifold, outward, and nothing cuts itself.
  bool IsSound() const {
    return surface.closed && surface.manifold && surface.outward && self_intersections == 0;
  }
};

/// \param reference  surface that the mesh stands for, closed
/// \param samples  for the distances, each way; 0: they are not measured
MeshQuality InspectQuality(const geometry::TriangleMesh& mesh, const geometry::TriangleMesh& reference,
                           std::size_t samples);

}  // namespace trocar::meshing
