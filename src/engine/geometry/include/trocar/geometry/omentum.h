// SPDX-License-Identifier: Apache-2.0
/// \file omentum.h  The apron of fat that lies over the bowel, under the organs that are operated on: what is seen behind everything, and
/// what a stone that fell lies on.
///
/// Generated; it belongs to no patient.
#pragma once

#include <span>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

struct Ball {
  math::Vec3 centre;  ///< [m]
  double radius = 0;  ///< [m]
};

/// Height field of fat lobules that passes under every ball.
///
/// \param above  parts that must stay visible above it: organs, ducts, vessels; world frame
/// \return  open sheet that faces +z; the same bits for the same argument
TriangleMesh MakeOmentum(std::span<const Ball> above);

}  // namespace trocar::geometry
