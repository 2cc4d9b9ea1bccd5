// SPDX-License-Identifier: Apache-2.0
/// \file structure_mesh.h  A mesh with the name of the structure that it is.
#pragma once

#include <string>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Closed mesh of one structure in the frame of the pictures: column, row, slice times their distances [mm].
struct StructureMesh {
  std::string name;
  geometry::TriangleMesh mesh;
};

}  // namespace trocar::meshing
