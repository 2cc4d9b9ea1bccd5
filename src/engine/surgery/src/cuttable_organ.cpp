// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/cuttable_organ.h"

#include <algorithm>
#include <utility>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::surgery {

using geometry::Edge;
using geometry::EditableMesh;
using geometry::kNone;
using geometry::Triangle;
using geometry::VertexOrigin;

namespace {

/// Triangles that a cut may add for each vertex that it adds: splits add two, a trench up to four for a copy and a bottom.
constexpr std::size_t kTrianglesAVertex = 3;
/// Springs that may change with each triangle: three edges and three across, before and after.
constexpr std::size_t kPairsATriangle = 12;

template <typename T>
void SortUnique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

CuttableOrgan::CuttableOrgan(EditableMesh mesh, const CuttableOrganSettings& settings)
    : mesh_(std::move(mesh)), cutter_(mesh_), settings_(settings), given_count_(mesh_.VertexCount()) {
  positions_.reserve(mesh_.VertexCapacity());
  pairs_.reserve(kPairsATriangle * mesh_.TriangleCapacity());
  vertices_.reserve(6 * mesh_.TriangleCapacity());
}

base::Result<CuttableOrgan> CuttableOrgan::Make(const geometry::TriangleMesh& mesh,
                                                const CuttableOrganSettings& settings) {
  auto editable = EditableMesh::Make(mesh, settings.spare_count, kTrianglesAVertex * settings.spare_count);
  if (!editable.ok()) return editable.error();
  if (settings.cut.has_walls && !geometry::InspectMesh(mesh).closed) {
    return base::Error{
        base::ErrorCode::kMeshNotClosed,
        "a solid organ has holes, so a cut in it cannot be closed by walls; close its surface, or cut it "
        "as a hollow organ"};
  }
  return CuttableOrgan(std::move(*editable), settings);
}

void CuttableOrgan::ReserveFor(TopologyChange& change) const {
  change.Reserve(change.nodes.capacity() + mesh_.VertexCapacity(),
                 change.springs.capacity() + kPairsATriangle * mesh_.TriangleCapacity(),
                 change.cut_strands.capacity());
}

std::vector<Triangle> CuttableOrgan::NodeTriangles() const {
  std::vector<Triangle> triangles(mesh_.Triangles().begin(), mesh_.Triangles().end());
  for (Triangle& t : triangles) t = {Node(t[0]), Node(t[1]), Node(t[2])};
  return triangles;
}

geometry::CutReport CuttableOrgan::Cut(const geometry::BladeEdge& before, const geometry::BladeEdge& now,
                                       std::span<const math::Vec3> position, geometry::CutFront& front,
                                       TopologyChange& change) noexcept {
  positions_.resize(mesh_.VertexCount());
  for (std::uint32_t v = 0; v < positions_.size(); ++v) positions_[v] = position[Node(v)];
  mesh_.SetPositions(positions_);
  mesh_.ClearJournal();
  const geometry::CutReport report = cutter_.Cut(before, now, settings_.cut, front, mesh_);
  if (report.HasChanged()) {
    ListPairs();
    ListChanges(change);
  }
  return report;
}

void CuttableOrgan::ListPair(std::uint32_t a, std::uint32_t b) noexcept {
  if (a != kNone && b != kNone && a != b) pairs_.push_back({std::min(a, b), std::max(a, b)});
}

/// The springs of a triangle: its sides, and over each side to the corner beyond.
void CuttableOrgan::ListTriangle(const Triangle& corners, const Triangle& across) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    ListPair(corners[i], corners[(i + 1) % 3]);
    ListPair(corners[(i + 2) % 3], across[i]);
    vertices_.push_back(corners[i]);
  }
}

void CuttableOrgan::ListPairs() noexcept {
  pairs_.clear();
  vertices_.clear();
  const auto list_now = [&](std::uint32_t t) {
    ListTriangle(mesh_.Triangles()[t],
                 {mesh_.Across(3 * t), mesh_.Across(3 * t + 1), mesh_.Across(3 * t + 2)});
  };
  for (const geometry::TouchedTriangle& touched : mesh_.Journal()) {
    ListTriangle(touched.corners, touched.across);
    list_now(touched.triangle);
  }
  for (auto t = static_cast<std::uint32_t>(mesh_.JournalTriangles()); t < mesh_.TriangleCount(); ++t)
    list_now(t);
  SortUnique(pairs_);
  SortUnique(vertices_);
}

/// The pair of vertices of before this tick whose spring the one between a and b continues.
std::array<std::uint32_t, 2> CuttableOrgan::FindParent(std::uint32_t a, std::uint32_t b) const noexcept {
  const auto sources = mesh_.Sources();
  const std::size_t old_count = mesh_.JournalVertices();
  const auto original = [&](std::uint32_t v) {
    while (v >= old_count && sources[v].origin == VertexOrigin::kCopy) v = sources[v].from[0];
    return v;
  };
  a = original(a), b = original(b);
  if (a > b) std::swap(a, b);
  // an edge may be split more than once in a tick: climb to the whole one
  for (int climbs = 0; b >= old_count && climbs < 8; ++climbs) {
    const geometry::VertexSource& source = sources[b];
    if (source.origin != VertexOrigin::kSplit || source.from[2] != kNone) return {kNone, kNone};
    const std::uint32_t p = original(source.from[0]), q = original(source.from[1]);
    if (a != p && a != q) return {kNone, kNone};
    a = std::min(p, q), b = std::max(p, q);
  }
  if (b >= old_count) return {kNone, kNone};
  return {Node(a), Node(b)};
}

void CuttableOrgan::ListChanges(TopologyChange& change) noexcept {
  const std::size_t old_count = mesh_.JournalVertices();
  for (const auto v : vertices_) {
    const WallNode wall = CalcWallNode(mesh_, v, settings_.wall);
    NodeChange node;
    node.node = Node(v);
    node.is_new = v >= old_count;
    node.mass = wall.mass;
    node.shape_stiffness = wall.shape_stiffness;
    if (node.is_new) {
      const geometry::VertexSource& source = mesh_.Sources()[v];
      for (std::size_t i = 0; i < 3; ++i)
        node.from[i] = source.from[i] == kNone ? kNone : Node(source.from[i]);
      node.weights = source.weights;
      node.rest = mesh_.Rest()[v];
      node.position = mesh_.Positions()[v];
    }
    change.nodes.push_back(node);
  }
  for (const Edge& pair : pairs_) {
    const tissue::Spring spring = CalcWallSpring(mesh_, pair[0], pair[1], settings_.wall);
    // a pair that never had a spring and has none now, between vertices that came and went within the tick
    if (spring.stiffness <= 0.0 && pair[1] >= old_count) continue;
    const std::uint32_t a = Node(pair[0]), b = Node(pair[1]);
    change.springs.push_back({std::min(a, b), std::max(a, b), spring.stiffness, spring.rest_length,
                              spring.law, FindParent(pair[0], pair[1])});
  }
}

}  // namespace trocar::surgery
