// SPDX-License-Identifier: Apache-2.0
/// \file marching_cubes.h  Surface of a scalar volume: closed, manifold and outward for every input.
/// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987; ambiguous faces: Nielson and Hamann, "The
/// asymptotic decider: resolving the ambiguity in marching cubes", Visualization 1991. The tables are
/// generated.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/meshing/volume.h"

namespace trocar::meshing {

/// Loop of cut cell edges, where the surface crosses the cell's faces.
///
/// Corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1); edge e joins kCellEdges[e]. Each loop is closed by a
/// disc of its own: a fan from its first edge, or from its centre where every fan would put a side into a
/// cell's face, where the neighbour might have the same one. So parts that meet only through a tunnel inside
/// one cell stay apart: the choice touches no other cell.
struct CellLoop {
  std::vector<std::uint8_t> edges;  ///< at least 3, counter-clockwise seen from outside
  bool has_centre = false;
};
extern const std::array<std::array<std::uint8_t, 2>, 12> kCellEdges;

/// Corners of each face, counter-clockwise seen from outside the cell.
extern const std::array<std::array<std::uint8_t, 4>, 6> kCellFaces;

/// Faces whose inside corners lie across from each other: bit f set for face f.
/// \param inside  bit c set: corner c is inside, 0 to 255
unsigned FindAmbiguousFaces(unsigned inside);

/// \param joined  bit f set: on face f the two inside corners hang together; a subset of the ambiguous faces
const std::vector<CellLoop>& FindCellLoops(unsigned inside, unsigned joined);

/// The asymptotic decider: whether the bilinear interpolant of a face is inside at its saddle, a c > b d.
/// Products of floats are exact in double, so that both cells of a face always agree; a tie keeps them apart.
/// \param a, c  values of the inside corners, > 0;
/// \param b, d  of the others, <= 0
inline bool IsJoinedAtSaddle(float a, float b, float c, float d) {
  return static_cast<double>(a) * c > static_cast<double>(b) * d;
}

/// Surface where the values pass zero; exactly zero counts as outside, as does what is not a number.
///
/// The volume is taken as surrounded by outside. Vertices stay at least a fiftieth of an edge away from its
/// ends, so that no triangle collapses. The same bits for any number of threads.
/// \return closed, manifold, outward mesh [mm], positions as ScalarVolume::Position; empty when nothing is
/// inside
geometry::TriangleMesh MarchCubes(const ScalarVolume& volume);

}  // namespace trocar::meshing
