// SPDX-License-Identifier: Apache-2.0
/// \file omentum_drape.h  Fat over ducts and vessels where nobody dissects: the bile duct away from what joins it, and every end
/// where the model of a tube stops in the air. Looks only: what rolls and runs meets the omentum as the simulation has it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::view {

/// A duct or vessel at the start.
struct TubeLine {
  std::vector<math::Vec3> nodes;  ///< [m]
  double radius = 0;              ///< [m]
  bool is_in_fat = false;         ///< it runs in fat wherever nothing joins it, not only at a loose end
};

/// A place that fat covers.
struct CoveredPlace {
  math::Vec3 centre;  ///< of the tube [m]
  double height = 0;  ///< of the fat above that; below 0 it lies under it [m]
};

/// Places along the tubes, and on beyond the ends that lie near no other tube and near no organ: there they sink.
/// \param tubes   those of fewer than two nodes are left out
/// \param organs  vertices of all organs [m]
std::vector<CoveredPlace> FindCoveredPlaces(std::span<const TubeLine> tubes,
                                            std::span<const math::Vec3> organs);

/// Raises a height field over places: a ridge with the lobules of fat, whose feet run out into it.
/// \param[in,out] omentum  faces +z; the same bits for the same arguments
/// \return  (vertices) how far each was raised [m]
std::vector<double> DrapeOmentum(std::span<const CoveredPlace> places, geometry::TriangleMesh& omentum);

/// Lowers the rims of a height field where it falls off steeply, so that they are round. Nothing is raised: what it lay under
/// stays over it.
void RoundRims(geometry::TriangleMesh& omentum);

}  // namespace trocar::view
