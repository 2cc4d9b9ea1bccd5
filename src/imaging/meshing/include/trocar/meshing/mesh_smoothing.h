// SPDX-License-Identifier: Apache-2.0
/// \file mesh_smoothing.h  Takes the stairs of slices and cells off a surface and keeps its volume.
/// Source: Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995.
#pragma once

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Strength of the smoothing.
struct SmoothingSettings {
  int iterations = 120;     ///< pairs of one shrinking and one swelling step
  double shrink = 0.5;      ///< lambda [-], 0 to 1
  double pass_band = 0.08;  ///< spatial frequencies below it are kept [-]; mu = 1 / (pass_band - 1 / lambda)
};

/// Smooths by the umbrella operator, then moves all vertices along their normals until the volume is as
/// before.
/// \pre closed, manifold, outward mesh (TROCAR_ASSERT on the volume)
void SmoothMesh(geometry::TriangleMesh& mesh, const SmoothingSettings& settings = {});

/// Moves all vertices by one distance along their normals so that the mesh encloses `volume`, to 1e-6 of it.
/// \param volume  in the mesh's unit cubed, > 0; within a few per cent of the present one
void SetVolume(geometry::TriangleMesh& mesh, double volume);

}  // namespace trocar::meshing
