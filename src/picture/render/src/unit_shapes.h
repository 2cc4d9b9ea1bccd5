// SPDX-License-Identifier: Apache-2.0
/// \file unit_shapes.h  Shapes of size 1 that the renderer scales into place: arrows.
#pragma once

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::render {

/// Rod and cone along +z with radius and length 1, so that each can be scaled along its axis.
geometry::TriangleMesh MakeUnitRod();
geometry::TriangleMesh MakeUnitCone();

}  // namespace trocar::render
