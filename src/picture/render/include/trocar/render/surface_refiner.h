// SPDX-License-Identifier: Apache-2.0
/// \file surface_refiner.h  A rounder surface for drawing: every triangle in four, bent by its normals.
/// Source: Vlachos, Peters, Boyd, Mitchell, "Curved PN triangles", I3D 2001 (edge midpoints only).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::render {

/// Connectivity of the finer surface, worked out once; then shape after shape.
class SurfaceRefiner {
 public:
  /// \param triangles  of the coarse surface with `vertex_count` vertices
  SurfaceRefiner(std::span<const geometry::Triangle> triangles, std::size_t vertex_count);

  /// Four for each coarse one.
  std::span<const geometry::Triangle> Triangles() const { return triangles_; }
  /// The coarse vertices, then one for each edge.
  std::size_t VertexCount() const { return coarse_count_ + edges_.size(); }

  /// Fine vertex n lies in the middle of edge n - coarse vertices.
  std::span<const geometry::Edge> Edges() const { return edges_; }

  /// \param positions, normals  of the coarse vertices [m], unit
  /// \param[out] fine_positions, fine_normals  (VertexCount())
  /// \note No allocation, lock or throw.
  void Refine(std::span<const math::Vec3> positions, std::span<const math::Vec3> normals,
              std::span<math::Vec3> fine_positions, std::span<math::Vec3> fine_normals) const;

 private:
  std::size_t coarse_count_;
  std::vector<geometry::Edge> edges_;
  std::vector<geometry::Triangle> triangles_;
};

}  // namespace trocar::render
