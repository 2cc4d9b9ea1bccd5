// SPDX-License-Identifier: Apache-2.0
/// \file tube.h  Ducts and vessels: a centre line with radii, and the skin around it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// Centre line of one duct or vessel, from its first point to its last.
struct CentreLine {
  std::vector<math::Vec3> points;  ///< (n) n >= 2 [m]
  std::vector<double> radii;       ///< (n) outer radius at each point [m], > 0

  friend bool operator==(const CentreLine&, const CentreLine&) = default;
};

/// Arc length of the polygon through the points [m].
double CalcLength(const CentreLine& line);

/// The line with points about `spacing` [m] apart along its cubic spline. The ends stay exact. Radii are interpolated
/// linearly.
CentreLine Resample(const CentreLine& line, double spacing);

/// Connectivity of a tube's skin around n centre-line points: `sides` vertices a ring, capped at both ends by
/// fans. Vertices: n rings in order, then the first and the last centre point. Closed and outward.
std::vector<Triangle> MakeTubeTriangles(std::size_t point_count, int sides);

/// Vertex positions for MakeTubeTriangles, by parallel transport of the ring's frame along the line.
///
/// \param points  (n) centre line [m]
/// \param radii   (n) [m]
/// \param[out] skin  (n * sides + 2) [m]
/// \note Real-time safe: no allocation, lock or throw.
void CalcTubeSkin(std::span<const math::Vec3> points, std::span<const double> radii, int sides,
                  std::span<math::Vec3> skin) noexcept;

/// MakeTubeTriangles and CalcTubeSkin together.
TriangleMesh MakeTube(const CentreLine& line, int sides);

}  // namespace trocar::geometry
