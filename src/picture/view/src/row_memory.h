// SPDX-License-Identifier: Apache-2.0
/// \file row_memory.h  Memory of a vertex while surgery changes the surface round it: its place in the patterns and its shade.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::view {

/// One entry a row of Snapshot::positions. Rows that a cut brings into use learn from their neighbours.
struct RowMemory {
  std::vector<math::Vec3> rest;           ///< where the material's pattern sticks to it [m]
  std::vector<double> ambient_occlusion;  ///< of render/ambient_occlusion.h [-]
  std::vector<std::uint8_t> is_known;

  void Resize(std::size_t rows) {
    rest.resize(rows);
    ambient_occlusion.resize(rows, 1.0);
    is_known.resize(rows, 0);
  }
  void Set(std::size_t row, const math::Vec3& place, double occlusion) {
    rest[row] = place;
    ambient_occlusion[row] = occlusion;
    is_known[row] = 1;
  }
  /// A row that lies near one that is known.
  /// \param offset  from it [m]
  void Learn(std::size_t row, std::size_t known, const math::Vec3& offset) {
    Set(row, rest[known] + offset, ambient_occlusion[known]);
  }
};

}  // namespace trocar::view
