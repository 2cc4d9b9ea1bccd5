// SPDX-License-Identifier: Apache-2.0
/// \file marching_cubes.h  Surface of a scalar volume: closed, manifold and outward for every input.
/// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987. The table is generated: on an ambiguous face
/// inside corners are always kept apart, and no triangle's inner side lies in a cell's face (Nielson and
/// Hamann, "The asymptotic decider", Visualization 1991, describes the holes and doubled edges that this
/// avoids).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/anatomy/volume.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::anatomy {

/// Loops of cut cell edges, one table entry for each of the 256 signs of the corners.
///
/// Corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1); edge e joins kCellEdges[e]. Each loop is triangulated as
/// a fan from its first edge, or from its centre where every fan would put a side into a cell's face.
struct CellLoop {
  std::vector<std::uint8_t> edges;  ///< at least 3, counter-clockwise seen from outside
  bool has_centre = false;
};
extern const std::array<std::array<std::uint8_t, 2>, 12> kCellEdges;

/// \param inside  bit c set: corner c is inside, 0 to 255
const std::vector<CellLoop>& FindCellLoops(unsigned inside);

/// Surface where the values pass zero.
///
/// The volume is taken as surrounded by outside. Vertices stay at least a fiftieth of an edge away from its
/// ends, so that no triangle collapses. \return closed, manifold, outward mesh [mm], positions as
/// ScalarVolume::Position; empty when nothing is inside
geometry::TriangleMesh MarchCubes(const ScalarVolume& volume);

}  // namespace trocar::anatomy
