// SPDX-License-Identifier: Apache-2.0
/// \file liver_regions.h  Where the liver is held: diaphragmatic face, falciform and coronary ligament, found
/// from its shape.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.2.2.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/anatomy/patient_builder.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/meshing/nearest_surface.h"

namespace trocar::anatomy {

/// Directions in which the diaphragm and the abdominal wall lie, seen from the liver: right, cranial,
/// anterior.
extern const math::Vec3 kTowardsDiaphragm;

/// (vertices) unit normals of the surface as if it were blurred over a centimetre: which way a face looks,
/// whatever its nodules and dents.
std::vector<math::Vec3> CalcBroadNormals(const geometry::TriangleMesh& mesh,
                                         const geometry::Rows& neighbours);

struct LiverRegions {
  std::vector<std::uint32_t> diaphragmatic, falciform, coronary;  ///< vertices, ascending
};

/// \param liver  closed, outward; world frame [m]
/// \param falciform_x  sagittal plane of the falciform ligament [m]
LiverRegions FindLiverRegions(const geometry::TriangleMesh& liver, const meshing::NearestSurface& gallbladder,
                              double falciform_x, const RegionSettings& settings);

}  // namespace trocar::anatomy
