// SPDX-License-Identifier: Apache-2.0
/// \file triangle_mesh.h  Indexed triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::geometry {

using Triangle = std::array<std::uint32_t, 3>;

/// Surface of triangles; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<math::Vec3> positions;  ///< (nv) [m] unless said otherwise
  std::vector<Triangle> triangles;    ///< (nt) indices into positions

  friend bool operator==(const TriangleMesh&, const TriangleMesh&) = default;
};

/// Axis-aligned box.
struct Box {
  math::Vec3 min, max;
};

}  // namespace trocar::geometry
