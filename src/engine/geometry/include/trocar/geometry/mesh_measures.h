// SPDX-License-Identifier: Apache-2.0
/// \file mesh_measures.h  Measures of a mesh: size, closedness, normals, quality.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// Bounding box; all zero for no points.
Box CalcBox(std::span<const math::Vec3> positions);

/// Normal of a triangle times twice its area [m^2].
math::Vec3 CalcAreaNormal(std::span<const math::Vec3> positions, const Triangle& triangle);

/// Smallest angle of a triangle [rad].
/// \note Real-time safe.
double CalcSmallestAngle(const math::Vec3& a, const math::Vec3& b, const math::Vec3& c) noexcept;

/// Sum of the triangles' areas [m^2].
double CalcArea(std::span<const math::Vec3> positions, std::span<const Triangle> triangles);

/// Volume by the divergence theorem, V = 1/6 sum x_a . (x_b x x_c) [m^3]; negative when inside out.
/// \pre closed mesh; otherwise the value depends on the origin
double CalcVolume(std::span<const math::Vec3> positions, std::span<const Triangle> triangles);

/// Unit normals of vertices, weighted by the angles of their triangles (Thuermer and Wuethrich 1998).
/// \param[out] normals  (nv); {0, 0, 1} where a vertex has no area
/// \note Real-time safe: no allocation, lock or throw.
void CalcVertexNormals(std::span<const math::Vec3> positions, std::span<const Triangle> triangles,
                       std::span<math::Vec3> normals);

/// Area that belongs to each vertex: a third of its triangles' [m^2], (nv).
std::vector<double> CalcVertexAreas(std::span<const math::Vec3> positions,
                                    std::span<const Triangle> triangles);

/// Findings about a mesh as a surface.
struct MeshReport {
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t components = 0;      ///< of vertices, by edges
  std::size_t boundary_edges = 0;  ///< edges of one triangle
  std::size_t odd_edges = 0;       ///< edges of three or more triangles, or of two that run the same way
  std::size_t odd_vertices = 0;    ///< vertices whose triangles are not one fan
  std::size_t degenerate = 0;      ///< triangles without area or with a repeated index
  int genus = 0;                   ///< sum over the components; meaningful when closed and manifold
  double area = 0;                 ///< [m^2]
  double volume = 0;               ///< [m^3], positive when the triangles face outwards
  double min_angle = 0;            ///< smallest angle of any triangle [rad]
  double mean_min_angle = 0;       ///< mean over the triangles of their smallest angle [rad]
  bool closed = false;             ///< no boundary edge
  bool manifold = false;           ///< no odd edge, odd vertex or degenerate triangle
  bool outward = false;            ///< volume > 0
};

MeshReport InspectMesh(const TriangleMesh& mesh);

/// Whether two boxes share a point.
bool BoxesOverlap(const Box& a, const Box& b) noexcept;

/// Whether two triangles of a mesh cut each other: without a common vertex, if they share any point; with
/// one, if they meet beyond it. Neighbours along an edge never do.
/// \param a_corners, b_corners  (3) positions
/// \note Real-time safe.
bool TrianglesCut(const Triangle& a, const math::Vec3* a_corners, const Triangle& b,
                  const math::Vec3* b_corners) noexcept;

/// Pairs of triangles that cut each other (TrianglesCut), smaller index first, ascending.
/// Grid-accelerated; not real-time safe.
/// \pre coordinates finite, indices in range
std::vector<std::array<std::uint32_t, 2>> FindSelfIntersections(const TriangleMesh& mesh);

/// How many FindSelfIntersections finds.
std::size_t CountSelfIntersections(const TriangleMesh& mesh);

/// Indices in range and coordinates finite, or kMeshInvalid with the first offender.
base::Status CheckMesh(const TriangleMesh& mesh);

}  // namespace trocar::geometry
