// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/surface_refiner.h"

#include <algorithm>

#include "trocar/base/assert.h"

namespace trocar::render {

using geometry::Edge;
using math::Vec3;

SurfaceRefiner::SurfaceRefiner(std::span<const geometry::Triangle> triangles, std::size_t vertex_count)
    : coarse_count_(vertex_count), edges_(geometry::FindEdges(triangles)) {
  const auto middle = [this](std::uint32_t a, std::uint32_t b) {
    const Edge edge{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    return static_cast<std::uint32_t>(coarse_count_ + static_cast<std::size_t>(found - edges_.begin()));
  };
  triangles_.reserve(4 * triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    triangles_.insert(triangles_.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
}

void SurfaceRefiner::Refine(std::span<const Vec3> positions, std::span<const Vec3> normals,
                            std::span<Vec3> fine_positions, std::span<Vec3> fine_normals) const {
  TROCAR_ASSERT(positions.size() == coarse_count_ && normals.size() == coarse_count_);
  TROCAR_ASSERT(fine_positions.size() == VertexCount() && fine_normals.size() == VertexCount());
  std::copy(positions.begin(), positions.end(), fine_positions.begin());
  std::copy(normals.begin(), normals.end(), fine_normals.begin());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [a, b] = edges_[i];
    const Vec3 way = positions[b] - positions[a];
    // middle of the cubic whose ends stand square to the normals
    fine_positions[coarse_count_ + i] =
        0.5 * (positions[a] + positions[b]) -
        0.125 * (math::Dot(way, normals[a]) * normals[a] - math::Dot(way, normals[b]) * normals[b]);
    fine_normals[coarse_count_ + i] = math::Normalized(normals[a] + normals[b], normals[a]);
  }
}

}  // namespace trocar::render
