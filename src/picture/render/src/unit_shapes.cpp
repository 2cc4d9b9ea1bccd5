// SPDX-License-Identifier: Apache-2.0
#include "unit_shapes.h"

#include "trocar/geometry/tube.h"

namespace trocar::render {

geometry::TriangleMesh MakeUnitRod() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 1.0}}, 16);
}

geometry::TriangleMesh MakeUnitCone() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 0.02}}, 16);
}

}  // namespace trocar::render
