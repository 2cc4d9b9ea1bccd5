// SPDX-License-Identifier: Apache-2.0
/// \file random_triangles.h  Points and triangles without any order, for tests against brute force.
#pragma once

#include <cstdint>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/random.h"

namespace trocar::collision {

/// In a cube of that half side [m].
inline math::Vec3 RandomPoint(math::Random& random, double reach = 1.0) {
  return {random.Uniform(-reach, reach), random.Uniform(-reach, reach), random.Uniform(-reach, reach)};
}

/// \param size  of each triangle [m]
inline geometry::TriangleMesh MakeSoup(math::Random& random, int count, double size) {
  geometry::TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const math::Vec3 centre = RandomPoint(random, 0.1);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(centre + RandomPoint(random, size));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace trocar::collision
