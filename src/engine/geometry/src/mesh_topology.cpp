// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/mesh_topology.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace trocar::geometry {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Rows from (row, value) pairs: sorted within a row, repeated pairs kept once.
Rows MakeRows(std::span<const Pair> pairs, std::size_t count) {
  // counting sort by row, then each short row by itself
  std::vector<std::uint32_t> ends(count + 1, 0), values(pairs.size());
  for (const Pair& pair : pairs) ++ends[pair.first + 1];
  for (std::size_t i = 0; i < count; ++i) ends[i + 1] += ends[i];
  for (const Pair& pair : pairs) values[ends[pair.first]++] = pair.second;
  Rows rows;
  rows.starts.reserve(count + 1);
  rows.starts.push_back(0);
  rows.values.reserve(pairs.size());
  for (std::size_t i = 0; i < count; ++i) {
    // filling moved each row's start to its end
    const auto begin = values.begin() + (i == 0 ? 0 : ends[i - 1]), end = values.begin() + ends[i];
    std::sort(begin, end);
    rows.values.insert(rows.values.end(), begin, std::unique(begin, end));
    rows.starts.push_back(static_cast<std::uint32_t>(rows.values.size()));
  }
  return rows;
}

}  // namespace

std::vector<Edge> FindEdges(std::span<const Triangle> triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
      edges.push_back({low, high});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

Rows FindVertexNeighbours(std::span<const Triangle> triangles, std::size_t vertex_count) {
  std::vector<Pair> pairs;
  pairs.reserve(6 * triangles.size());
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      pairs.emplace_back(t[i], t[(i + 1) % 3]);
      pairs.emplace_back(t[(i + 1) % 3], t[i]);
    }
  }
  return MakeRows(pairs, vertex_count);
}

Rows FindVertexTriangles(std::span<const Triangle> triangles, std::size_t vertex_count) {
  std::vector<Pair> pairs;
  pairs.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t vertex : triangles[i]) pairs.emplace_back(vertex, i);
  }
  return MakeRows(pairs, vertex_count);
}

std::vector<std::uint32_t> FindComponents(std::span<const Triangle> triangles, std::size_t vertex_count) {
  constexpr auto kUnseen = std::numeric_limits<std::uint32_t>::max();
  const Rows neighbours = FindVertexNeighbours(triangles, vertex_count);
  std::vector<std::uint32_t> component(vertex_count, kUnseen);
  std::vector<std::uint32_t> stack;
  std::uint32_t count = 0;
  for (std::uint32_t seed = 0; seed < vertex_count; ++seed) {
    if (component[seed] != kUnseen) continue;
    component[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::uint32_t vertex = stack.back();
      stack.pop_back();
      for (const std::uint32_t next : neighbours.Row(vertex)) {
        if (component[next] != kUnseen) continue;
        component[next] = count;
        stack.push_back(next);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace trocar::geometry
