// SPDX-License-Identifier: Apache-2.0
/// \file mesh_slice.h  Where a plane cuts a closed mesh: segments, closed loops, filled pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/vector.h"

namespace trocar::meshing {

/// From the cut of one triangle; `edges` name the mesh's edges that its ends lie on.
struct SliceSegment {
  math::Vec2 a, b;
  std::array<std::uint64_t, 2> edges;
};

/// The cut with the plane z = height.
std::vector<SliceSegment> CutMesh(const geometry::TriangleMesh& mesh, double height);

/// The segments of a closed mesh joined to closed polygons; each point once.
std::vector<std::vector<math::Vec2>> JoinLoops(const std::vector<SliceSegment>& segments);

/// Twice-signed area of a polygon by the shoelace formula, halved: > 0 counter-clockwise where y grows up.
double CalcPolygonArea(const std::vector<math::Vec2>& polygon);

/// Grid of pixels; pixel (i, j) has its centre at (i, j) times `pixel`.
struct SliceGrid {
  int width = 0, height = 0;
  double pixel = 1;
};

/// Share of each pixel that lies inside the cut, by samples x samples points a pixel (even-odd rule).
/// \return (height * width) [0, 1]
std::vector<float> CalcCoverage(const std::vector<SliceSegment>& segments, const SliceGrid& grid,
                                int samples);

}  // namespace trocar::meshing
