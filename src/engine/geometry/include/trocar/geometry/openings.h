// SPDX-License-Identifier: Apache-2.0
/// \file openings.h  The openings of a surface that was cut: rims, areas, and what would close them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/editable_mesh.h"

namespace trocar::geometry {

/// One loop of the boundary.
struct Opening {
  std::uint32_t half_edge = kNone;  ///< lowest of the rim; the others by NextOnRim
  std::size_t edges = 0;
  double length = 0;  ///< of the rim now [m]
  double area =
      0;  ///< of the rim's flat projection with the largest area, now [m^2]; 0 for a slit not yet drawn apart
};

/// The boundary half-edge that follows along the rim.
/// \pre Twin(h) == kNone
inline std::uint32_t NextOnRim(const EditableMesh& mesh, std::uint32_t h) {
  return mesh.FirstAround(mesh.To(h));
}

/// Finds the openings, lowest half-edge first.
///
/// \param[out] openings  the first ones that it has the capacity for
/// \return how many there are
/// \note Real-time safe.
std::size_t FindOpenings(const EditableMesh& mesh, std::span<Opening> openings) noexcept;

/// Triangles that close every opening: a fan from each rim's first vertex. For volumes, not for drawing: the fan may
/// fold over itself.
/// \note Not real-time safe: allocates.
std::vector<Triangle> MakeLids(const EditableMesh& mesh);

}  // namespace trocar::geometry
