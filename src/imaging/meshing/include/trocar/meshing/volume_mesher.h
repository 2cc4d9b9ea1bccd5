// SPDX-License-Identifier: Apache-2.0
/// \file volume_mesher.h  From a volume to the mesh of an organ: the one way that every patient takes.
#pragma once

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/meshing/mesh_quality.h"
#include "trocar/meshing/mesh_repair.h"
#include "trocar/meshing/mesh_smoothing.h"
#include "trocar/meshing/volume.h"

namespace trocar::meshing {

/// Triangles of the built-in patient's organs; other patients get as many.
inline constexpr int kLiverTriangles = 5132;
inline constexpr int kGallbladderTriangles = 1798;

struct MeshingSettings {
  int triangle_budget = kLiverTriangles;  ///< at most this many triangles, at least 98 % of it; >= 8
  SmoothingSettings smoothing;            ///< of the surface at the volume's own spacing
  double oversampling = 12.0;             ///< least triangles of the first surface for each one wanted
  double min_angle_deg = 8.0;             ///< smaller angles are repaired where a single edit does it
  /// Triangles with a smaller angle are slivers: all vertices around one are moved together, and where that does not help either,
  /// the surface is made anew with another smoothing. Below 5 degrees a triangle's springs and normal are useless, and
  /// the patient check warns; the hundredth outlasts the rounding of a file's numbers. 0: slivers are left.
  double sliver_angle_deg = 5.01;
  std::size_t distance_samples = 20000;  ///< for the distance to the volume's surface, each way; 0: none
};

struct MeshedVolume {
  geometry::TriangleMesh mesh;  ///< [mm], positions as ScalarVolume::Position
  MeshQuality quality;          ///< against the unsmoothed surface of the volume
  RepairReport repair;
};

/// Smooth closed mesh of the largest part of a volume, within a budget of triangles.
///
/// Largest part without cavities; marching cubes; smoothing that keeps the volume; decimation; repair. A
/// volume that is far finer than the budget can show is first halved in resolution by a binomial filter, as
/// often as the surface keeps a dozen triangles for each one wanted. Where triangles still cut each other or
/// slivers are left, the surface is smoothed more or less and tried again. The mesh encloses what the
/// volume's surface encloses, to 0.5 %.
/// \return kContourEmpty when nothing is inside, kMeshNotClosed when the budget cannot be reached. A mesh
/// that still cuts itself is returned: `quality` says so.
/// \note The same bits for any number of threads.
base::Result<MeshedVolume> MeshVolume(ScalarVolume volume, const MeshingSettings& settings = {});

/// Every second sample after a binomial filter (1 2 1) / 4 along each axis; outside counts as outside.
ScalarVolume HalveResolution(const ScalarVolume& volume);

}  // namespace trocar::meshing
