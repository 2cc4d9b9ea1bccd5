// SPDX-License-Identifier: Apache-2.0
/// \file label_neighbours.h  Meshes of the neighbours that a label map shows beside liver and gallbladder.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "label_measures.h"
#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"
#include "trocar/meshing/structure_mesh.h"

namespace trocar::anatomy {

/// Where the voxels of a label lie in the map.
struct LabelBox {
  std::size_t count = 0;
  std::array<int, 3> low{}, high{};  ///< first and last index along each axis
};
using LabelBoxes = std::map<std::int32_t, LabelBox>;

/// Of all labels but 0.
LabelBoxes FindLabelBoxes(const images::LabelVolume& volume);

/// Which labels are what, beside liver and gallbladder.
struct NeighbourLabels {
  std::map<int, roles::NeighbourRole> roles;  ///< several labels may be one neighbour, as ribs are
  /// Third and fourth lumbar vertebra, between which the navel lies; the surface of the body. 0: not known.
  int third_lumbar = 0, fourth_lumbar = 0, body = 0;
};

/// Labels beside liver and gallbladder, as FindLabels understood them.
NeighbourLabels FindNeighbourLabels(const OrganLabels& organs, const LabelBoxes& boxes);

/// One neighbour as a mesh in the map's frame (left, cranial, anterior) [mm].
struct NeighbourMesh {
  roles::NeighbourRole role = roles::NeighbourRole::kOther;
  geometry::TriangleMesh mesh;
  NeighbourReport report;
};

/// Everything of the labels that lies within kNeighbourReachMm of the box round liver and gallbladder; cut off there with flat faces. Each
/// part that hangs together is meshed by itself; small ones are left out, and `report` counts them.
/// \param[out] notes  sentences: what could not be meshed
std::vector<NeighbourMesh> MeshNeighbours(const images::LabelVolume& volume, const NeighbourLabels& labels,
                                          const OrganLabels& organs, const LabelBoxes& boxes,
                                          const VoxelFrame& frame, std::vector<std::string>& notes);
inline constexpr double kNeighbourReachMm = 60.0;

}  // namespace trocar::anatomy
