// SPDX-License-Identifier: Apache-2.0
/// \file mesh_topology.h  Edges and neighbourhoods of a mesh's connectivity.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// Undirected edge, smaller index first.
using Edge = std::array<std::uint32_t, 2>;

/// Compressed rows: row i holds values[starts[i]] to values[starts[i + 1]].
struct Rows {
  std::vector<std::uint32_t> starts;  ///< (n + 1)
  std::vector<std::uint32_t> values;

  std::span<const std::uint32_t> Row(std::size_t i) const {
    return std::span(values).subspan(starts[i], starts[i + 1] - starts[i]);
  }
  std::size_t Count() const { return starts.empty() ? 0 : starts.size() - 1; }
};

/// Every edge once, sorted.
std::vector<Edge> FindEdges(std::span<const Triangle> triangles);

/// Neighbours of each of `vertex_count` vertices along edges, ascending.
Rows FindVertexNeighbours(std::span<const Triangle> triangles, std::size_t vertex_count);

/// Triangles around each of `vertex_count` vertices, ascending.
Rows FindVertexTriangles(std::span<const Triangle> triangles, std::size_t vertex_count);

/// Number of the connected component of each vertex, from 0, by edges; isolated vertices are components too.
std::vector<std::uint32_t> FindComponents(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace trocar::geometry
