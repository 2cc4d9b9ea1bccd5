// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/wall_holes.h"

#include <algorithm>
#include <numeric>

#include "trocar/geometry/openings.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

/// Whether two vertices are corners of one triangle.
bool AreNeighbours(const surgery::OrganSurface& organ, std::uint32_t a, std::uint32_t b) noexcept {
  const auto around = organ.vertex_triangles.Row(a);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
    const geometry::Triangle& corners = organ.triangles[t];
    return std::find(corners.begin(), corners.end(), b) != corners.end();
  });
}

Vec3 NormalAt(const surgery::OrganSurface& organ, std::span<const Vec3> nodes,
              std::uint32_t vertex) noexcept {
  Vec3 sum;
  for (const std::uint32_t t : organ.vertex_triangles.Row(vertex)) {
    const auto& [a, b, c] = organ.triangles[t];
    sum += math::Cross(nodes[b] - nodes[a], nodes[c] - nodes[a]);
  }
  return math::Normalized(sum);
}

}  // namespace

void WallHoles::Add(std::uint32_t node, double rim) noexcept {
  const auto end = places_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto known =
      std::find_if(places_.begin(), end, [node](const Place& place) { return place.node == node; });
  if (known != end) {
    known->rim = std::max(known->rim, rim);
  } else if (count_ < kMost) {
    places_[count_++] = {node, rim};
  }
}

WallHole WallHoles::FindLargest(const surgery::OrganSurface& organ, std::span<const Vec3> positions,
                                const geometry::EditableMesh& mesh) const noexcept {
  WallHole largest;
  const auto nodes = organ.Nodes(positions);
  // nodes that hang together, each group named by its first
  std::array<std::size_t, kMost> group;
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (group[j] == group[i] ||
          !AreNeighbours(organ, places_[i].node - organ.first_node, places_[j].node - organ.first_node))
        continue;
      const std::size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(i) + 1, from, to);
    }
  }
  for (std::size_t g = 0; g < count_; ++g) {
    if (group[g] != g) continue;
    WallHole hole;
    double reach = 0, own = 0, members = 0;
    for (std::size_t i = g; i < count_; ++i) {
      if (group[i] != g) continue;
      const Vec3& p = positions[places_[i].node];
      hole.position += p;
      hole.outwards += NormalAt(organ, nodes, places_[i].node - organ.first_node);
      own = std::max(own, places_[i].rim);
      members += 1.0;
      for (std::size_t j = g; j < i; ++j) {
        if (group[j] == g) reach = std::max(reach, math::Distance(p, positions[places_[j].node]));
      }
    }
    // there and back
    hole.rim = own + 2.0 * reach;
    hole.position = hole.position / members;
    hole.outwards = math::Normalized(hole.outwards);
    if (hole.rim > largest.rim) largest = hole;
  }
  std::array<geometry::Opening, 8> openings;
  const std::size_t found = std::min(openings.size(), geometry::FindOpenings(mesh, openings));
  for (const geometry::Opening& opening : std::span(openings).first(found)) {
    if (!(opening.length > largest.rim)) continue;
    WallHole hole;
    std::uint32_t side = opening.half_edge;
    for (std::size_t i = 0; i < opening.edges; ++i) {
      hole.position += nodes[mesh.From(side)] / static_cast<double>(opening.edges);
      hole.outwards += NormalAt(organ, nodes, mesh.From(side));
      side = geometry::NextOnRim(mesh, side);
    }
    hole.outwards = math::Normalized(hole.outwards);
    hole.rim = opening.length;
    largest = hole;
  }
  return largest;
}

void WallHoles::VisitState(base::StateArchive& archive) {
  archive.Field("count", count_);
  if (archive.IsRestoring() && count_ > kMost) {
    count_ = 0;
    archive.Fail("exceed their capacity");
  }
  for (Place& place : std::span(places_).first(count_)) {
    archive.Field("node", place.node);
    archive.Field("rim", place.rim);
  }
}

}  // namespace trocar::surgery
