// SPDX-License-Identifier: Apache-2.0
#include "editable_surface.h"

#include <algorithm>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::meshing {

using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

namespace {

bool Holds(const Triangle& t, std::uint32_t v) {
  return t[0] == v || t[1] == v || t[2] == v;
}

}  // namespace

EditableSurface::EditableSurface(const TriangleMesh& mesh)
    : positions_(mesh.positions),
      triangles_(mesh.triangles),
      alive_(mesh.triangles.size(), 1),
      around_(mesh.positions.size()),
      live_(mesh.triangles.size()) {
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (const auto v : triangles_[t]) around_[v].push_back(t);
  }
}

Vec3 EditableSurface::AreaNormal(const Triangle& t) const {
  return geometry::CalcAreaNormal(positions_, t);
}

void EditableSurface::GatherNeighbours(std::uint32_t v, std::vector<std::uint32_t>& ring) const {
  ring.clear();
  // each triangle gives the neighbour that follows v: in a closed fan that is each one once
  for (const auto t : around_[v]) {
    const Triangle& triangle = triangles_[t];
    ring.push_back(triangle[0] == v ? triangle[1] : triangle[1] == v ? triangle[2] : triangle[0]);
  }
  std::sort(ring.begin(), ring.end());
}

bool EditableSurface::AreNeighbours(std::uint32_t v, std::uint32_t w) const {
  return std::any_of(around_[v].begin(), around_[v].end(),
                     [&](std::uint32_t t) { return Holds(triangles_[t], w); });
}

EdgeNeighbours EditableSurface::FindAcross(std::uint32_t t, int i) const {
  EdgeNeighbours edge;
  edge.t = edge.other = t;
  edge.a = triangles_[t][i], edge.b = triangles_[t][(i + 1) % 3], edge.c = triangles_[t][(i + 2) % 3];
  for (const auto u : around_[edge.a]) {
    if (u != t && Holds(triangles_[u], edge.b)) edge.other = u;
  }
  for (const auto v : triangles_[edge.other]) {
    if (v != edge.a && v != edge.b) edge.d = v;
  }
  return edge;
}

bool EditableSurface::CanCollapse(std::uint32_t a, std::uint32_t b) const {
  GatherNeighbours(a, ring_a_);
  GatherNeighbours(b, ring_b_);
  if (ring_a_.size() + ring_b_.size() < 8) return false;
  std::size_t shared = 0, i = 0, k = 0;
  while (i < ring_a_.size() && k < ring_b_.size()) {
    if (ring_a_[i] < ring_b_[k]) {
      ++i;
    } else if (ring_b_[k] < ring_a_[i]) {
      ++k;
    } else {
      ++shared;
      if (around_[ring_a_[i]].size() <= 3) return false;
      ++i, ++k;
    }
  }
  return shared == 2;
}

bool EditableSurface::CanFlip(const EdgeNeighbours& edge) const {
  return edge.other != edge.t && edge.c != edge.d && around_[edge.a].size() > 3 &&
         around_[edge.b].size() > 3 && !AreNeighbours(edge.c, edge.d);
}

void EditableSurface::Collapse(std::uint32_t a, std::uint32_t b, const Vec3& p) {
  positions_[a] = p;
  for (const auto t : around_[b]) {
    Triangle& triangle = triangles_[t];
    if (Holds(triangle, a)) {
      alive_[t] = 0;
      --live_;
      for (const auto v : triangle) {
        if (v != b) std::erase(around_[v], t);
      }
    } else {
      std::replace(triangle.begin(), triangle.end(), b, a);
      around_[a].push_back(t);
    }
  }
  around_[b].clear();
}

void EditableSurface::Flip(const EdgeNeighbours& edge) {
  triangles_[edge.t] = edge.FlippedFirst();
  triangles_[edge.other] = edge.FlippedSecond();
  std::erase(around_[edge.b], edge.t);
  std::erase(around_[edge.a], edge.other);
  around_[edge.d].push_back(edge.t);
  around_[edge.c].push_back(edge.other);
}

TriangleMesh EditableSurface::Take() const {
  TriangleMesh all{positions_, {}};
  all.triangles.reserve(live_);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (alive_[t]) all.triangles.push_back(triangles_[t]);
  }
  return DropUnusedVertices(all);
}

TriangleMesh DropUnusedVertices(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.positions.size(), kNoVertex);
  for (const Triangle& t : mesh.triangles) {
    for (const auto v : t) number[v] = 0;
  }
  TriangleMesh dense;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNoVertex) continue;
    number[v] = static_cast<std::uint32_t>(dense.positions.size());
    dense.positions.push_back(mesh.positions[v]);
  }
  dense.triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    dense.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return dense;
}

}  // namespace trocar::meshing
