// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/editable_mesh.h"

#include <algorithm>
#include <string>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/state_fields.h"

namespace trocar::geometry {

using math::Vec3;

base::Result<EditableMesh> EditableMesh::Make(const TriangleMesh& rest, std::size_t spare_vertices,
                                              std::size_t spare_triangles) {
  if (const auto status = CheckMesh(rest); !status.ok()) return status.error();
  const MeshReport report = InspectMesh(rest);
  if (!report.manifold || rest.triangles.empty()) {
    return base::Error{base::ErrorCode::kMeshInvalid,
                       "the surface cannot be cut: it has " + std::to_string(report.odd_edges) +
                           " edges and " + std::to_string(report.odd_vertices) +
                           " vertices of more than one sheet and " + std::to_string(report.degenerate) +
                           " triangles without area; repair it with trocar anatomy build or another program"};
  }
  EditableMesh mesh;
  mesh.vertex_capacity_ = rest.positions.size() + spare_vertices;
  mesh.triangle_capacity_ = rest.triangles.size() + spare_triangles;
  mesh.rest_.reserve(mesh.vertex_capacity_);
  mesh.positions_.reserve(mesh.vertex_capacity_);
  mesh.sources_.reserve(mesh.vertex_capacity_);
  mesh.outgoing_.reserve(mesh.vertex_capacity_);
  mesh.triangles_.reserve(mesh.triangle_capacity_);
  mesh.kinds_.reserve(mesh.triangle_capacity_);
  mesh.twins_.reserve(3 * mesh.triangle_capacity_);
  mesh.scored_.reserve(3 * mesh.triangle_capacity_);
  mesh.is_touched_.reserve(mesh.triangle_capacity_);
  mesh.journal_.reserve(mesh.triangle_capacity_);

  mesh.rest_ = rest.positions;
  mesh.positions_ = rest.positions;
  mesh.sources_.resize(rest.positions.size());
  mesh.outgoing_.assign(rest.positions.size(), kNone);
  mesh.triangles_ = rest.triangles;
  mesh.kinds_.assign(rest.triangles.size(), TriangleKind::kSurface);
  mesh.twins_.assign(3 * rest.triangles.size(), kNone);
  mesh.scored_.assign(3 * rest.triangles.size(), 0);
  mesh.is_touched_.assign(rest.triangles.size(), 0);

  // twins are neighbours in the list of half-edges sorted by their undirected edge
  std::vector<std::uint32_t> order(3 * rest.triangles.size());
  for (std::uint32_t h = 0; h < order.size(); ++h) {
    order[h] = h;
    mesh.outgoing_[mesh.From(h)] = h;
  }
  const auto edge = [&](std::uint32_t h) {
    return Edge{std::min(mesh.From(h), mesh.To(h)), std::max(mesh.From(h), mesh.To(h))};
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(edge(a), a) < std::pair(edge(b), b); });
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    if (edge(order[i]) == edge(order[i + 1])) mesh.SetTwins(order[i], order[i + 1]);
  }
  if (std::find(mesh.outgoing_.begin(), mesh.outgoing_.end(), kNone) != mesh.outgoing_.end()) {
    return base::Error{base::ErrorCode::kMeshInvalid,
                       "the surface cannot be cut: it has vertices that no triangle uses; drop them"};
  }
  mesh.ClearJournal();
  return mesh;
}

void EditableMesh::SetPositions(std::span<const Vec3> positions) noexcept {
  TROCAR_ASSERT(positions.size() == positions_.size());
  std::copy(positions.begin(), positions.end(), positions_.begin());
}

void EditableMesh::SetTwins(std::uint32_t h, std::uint32_t g) noexcept {
  if (h != kNone) twins_[h] = g;
  if (g != kNone) twins_[g] = h;
}

std::uint32_t EditableMesh::FirstAround(std::uint32_t v) const noexcept {
  const std::uint32_t start = outgoing_[v];
  for (std::uint32_t h = start;;) {
    const std::uint32_t twin = twins_[h];
    if (twin == kNone) return h;
    h = Next(twin);
    if (h == start) return start;
  }
}

std::uint32_t EditableMesh::FindHalfEdge(std::uint32_t a, std::uint32_t b) const noexcept {
  const std::uint32_t first = FirstAround(a);
  for (std::uint32_t h = first; h != kNone;) {
    if (To(h) == b) return h;
    h = NextAround(h);
    if (h == first) break;
  }
  return kNone;
}

std::uint32_t EditableMesh::FindEdge(std::uint32_t a, std::uint32_t b) const noexcept {
  const std::uint32_t h = FindHalfEdge(a, b);
  return h != kNone ? h : FindHalfEdge(b, a);
}

int EditableMesh::CountScored(std::uint32_t v) const noexcept {
  int count = 0;
  ForEachAround(v, [&](std::uint32_t h) { count += scored_[h]; });
  return count;
}

void EditableMesh::Touch(std::uint32_t t) noexcept {
  if (is_touched_[t] || t >= journal_triangles_) return;
  is_touched_[t] = 1;
  journal_.push_back({t, triangles_[t], {Across(3 * t), Across(3 * t + 1), Across(3 * t + 2)}});
}

void EditableMesh::ClearJournal() noexcept {
  for (const TouchedTriangle& touched : journal_) is_touched_[touched.triangle] = 0;
  journal_.clear();
  journal_vertices_ = VertexCount();
  journal_triangles_ = TriangleCount();
}

std::uint32_t EditableMesh::AddVertex(const VertexSource& source, const Vec3& rest,
                                      const Vec3& position) noexcept {
  TROCAR_ASSERT(HasCapacity(1, 0));
  rest_.push_back(rest);
  positions_.push_back(position);
  sources_.push_back(source);
  outgoing_.push_back(kNone);
  return static_cast<std::uint32_t>(rest_.size() - 1);
}

std::uint32_t EditableMesh::AddTriangle(const Triangle& corners, TriangleKind kind) noexcept {
  TROCAR_ASSERT(HasCapacity(0, 1));
  const auto t = static_cast<std::uint32_t>(triangles_.size());
  triangles_.push_back(corners);
  kinds_.push_back(kind);
  is_touched_.push_back(0);
  for (std::uint32_t i = 0; i < 3; ++i) {
    twins_.push_back(kNone);
    scored_.push_back(0);
    if (outgoing_[corners[i]] == kNone) outgoing_[corners[i]] = 3 * t + i;
  }
  return t;
}

void EditableMesh::Join(std::uint32_t h, std::uint32_t g) noexcept {
  TROCAR_ASSERT(twins_[h] == kNone && twins_[g] == kNone && From(h) == To(g) && To(h) == From(g));
  Touch(TriangleOf(h));
  Touch(TriangleOf(g));
  SetTwins(h, g);
}

std::uint32_t EditableMesh::SplitEdge(std::uint32_t h, double t) noexcept {
  TROCAR_ASSERT(HasCapacity(1, 2) && t > 0.0 && t < 1.0);
  const std::uint32_t a = From(h), b = To(h), c = Opposite(h);
  const std::uint32_t g = twins_[h];
  const std::uint8_t is_scored = scored_[h];
  const std::uint32_t p =
      AddVertex({VertexOrigin::kSplit, {a, b, kNone}, {1.0 - t, t, 0.0}}, math::Lerp(rest_[a], rest_[b], t),
                math::Lerp(positions_[a], positions_[b], t));
  // (a, b, c) becomes (a, p, c) and (p, b, c)
  Touch(TriangleOf(h));
  const std::uint32_t side = Next(h);
  const std::uint32_t beyond_side = twins_[side];
  const std::uint8_t side_is_scored = scored_[side];
  const std::uint32_t t_new = AddTriangle({p, b, c}, kinds_[TriangleOf(h)]);
  triangles_[TriangleOf(h)][Next(h) % 3] = p;
  SetTwins(3 * t_new + 1, beyond_side);
  scored_[3 * t_new + 1] = side_is_scored;
  SetTwins(3 * t_new + 2, side);
  scored_[side] = 0;
  scored_[3 * t_new] = is_scored;
  outgoing_[b] = 3 * t_new + 1;
  outgoing_[p] = 3 * t_new;
  if (g == kNone) {
    twins_[h] = kNone;
    return p;
  }
  // (b, a, d) becomes (p, a, d) and (b, p, d)
  Touch(TriangleOf(g));
  const std::uint32_t d = Opposite(g), last = Previous(g);
  const std::uint32_t beyond_last = twins_[last];
  const std::uint8_t last_is_scored = scored_[last];
  const std::uint32_t u_new = AddTriangle({b, p, d}, kinds_[TriangleOf(g)]);
  triangles_[TriangleOf(g)][g % 3] = p;
  SetTwins(3 * u_new + 2, beyond_last);
  scored_[3 * u_new + 2] = last_is_scored;
  SetTwins(3 * u_new + 1, last);
  scored_[last] = 0;
  scored_[3 * u_new] = is_scored;
  outgoing_[d] = 3 * u_new + 2;
  SetTwins(3 * t_new, 3 * u_new);
  SetTwins(h, g);
  return p;
}

std::uint32_t EditableMesh::SplitTriangle(std::uint32_t t, const std::array<double, 3>& weights) noexcept {
  TROCAR_ASSERT(HasCapacity(1, 2));
  const Triangle corners = triangles_[t];
  const auto at = [&](const std::vector<Vec3>& x) {
    return weights[0] * x[corners[0]] + weights[1] * x[corners[1]] + weights[2] * x[corners[2]];
  };
  const std::uint32_t p = AddVertex({VertexOrigin::kSplit, corners, weights}, at(rest_), at(positions_));
  // (a, b, c) becomes (a, b, p), (b, c, p) and (c, a, p)
  Touch(t);
  const std::uint32_t beyond[2] = {twins_[3 * t + 1], twins_[3 * t + 2]};
  const std::uint8_t are_scored[2] = {scored_[3 * t + 1], scored_[3 * t + 2]};
  const std::uint32_t second = AddTriangle({corners[1], corners[2], p}, kinds_[t]);
  const std::uint32_t third = AddTriangle({corners[2], corners[0], p}, kinds_[t]);
  triangles_[t][2] = p;
  SetTwins(3 * second, beyond[0]);
  SetTwins(3 * third, beyond[1]);
  scored_[3 * second] = are_scored[0];
  scored_[3 * third] = are_scored[1];
  scored_[3 * t + 1] = scored_[3 * t + 2] = 0;
  SetTwins(3 * t + 1, 3 * second + 2);
  SetTwins(3 * second + 1, 3 * third + 2);
  SetTwins(3 * third + 1, 3 * t + 2);
  outgoing_[corners[2]] = 3 * second + 1;
  outgoing_[p] = 3 * t + 2;
  return p;
}

void EditableMesh::SetScored(std::uint32_t h, bool is_scored) noexcept {
  TROCAR_ASSERT(twins_[h] != kNone);
  scored_[h] = scored_[twins_[h]] = is_scored;
}

int EditableMesh::CountCopies(std::uint32_t v) const noexcept {
  const int scored = CountScored(v);
  return IsBoundary(v) ? scored : std::max(scored - 1, 0);
}

int EditableMesh::SeparateParts(std::uint32_t v) noexcept {
  const int copies = CountCopies(v);
  if (copies == 0) return 0;
  const VertexSource copy = {VertexOrigin::kCopy, {v, kNone, kNone}, {1.0, 0.0, 0.0}};
  // start at a boundary or at a scored edge, and find the part that keeps v
  std::uint32_t first = FirstAround(v);
  while (twins_[first] != kNone && !scored_[first]) first = NextAround(first);
  int part = 0, keeps = 0;
  std::uint32_t lowest = kNone;
  for (std::uint32_t h = first; h != kNone;) {
    if (h != first && scored_[h]) ++part;
    if (TriangleOf(h) < lowest) lowest = TriangleOf(h), keeps = part;
    h = NextAround(h);
    if (h == first) break;
  }
  part = 0;
  std::uint32_t number = keeps == 0 ? v : AddVertex(copy, rest_[v], positions_[v]);
  for (std::uint32_t h = first; h != kNone;) {
    if (h != first && scored_[h]) {
      number = ++part == keeps ? v : AddVertex(copy, rest_[v], positions_[v]);
    }
    const std::uint32_t next = NextAround(h);
    if (number != v) {
      Touch(TriangleOf(h));
      triangles_[TriangleOf(h)][h % 3] = number;
    }
    outgoing_[number] = h;
    if (next == first) break;
    h = next;
  }
  return copies;
}

bool EditableMesh::Open(std::uint32_t h) noexcept {
  const std::uint32_t g = twins_[h];
  if (g == kNone || !scored_[h] || (From(h) == To(g) && To(h) == From(g))) return false;
  Touch(TriangleOf(h));
  Touch(TriangleOf(g));
  scored_[h] = scored_[g] = 0;
  twins_[h] = twins_[g] = kNone;
  return true;
}

namespace {

/// Numbers below `count`, or kNone.
bool AreIndices(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(),
                     [&](std::uint32_t i) { return i == kNone || i < count; });
}

}  // namespace

void EditableMesh::VisitState(base::StateArchive& archive) {
  archive.Field("rest", rest_);
  archive.Field("sources", sources_);
  archive.Field("outgoing", outgoing_);
  archive.Field("triangles", triangles_);
  archive.Field("kinds", kinds_);
  archive.Field("twins", twins_);
  archive.Field("scored", scored_);
  if (!archive.IsRestoring() || !archive.ok()) return;
  const std::size_t vertices = rest_.size(), triangles = triangles_.size();
  const bool fits = vertices <= vertex_capacity_ && triangles <= triangle_capacity_ &&
                    sources_.size() == vertices && outgoing_.size() == vertices &&
                    kinds_.size() == triangles && twins_.size() == 3 * triangles &&
                    scored_.size() == 3 * triangles;
  const auto is_corner = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < vertices; });
  };
  const auto is_source = [&](const VertexSource& source) { return AreIndices(source.from, vertices); };
  if (!fits || !std::all_of(triangles_.begin(), triangles_.end(), is_corner) ||
      !std::all_of(sources_.begin(), sources_.end(), is_source) || !AreIndices(twins_, 3 * triangles) ||
      !AreIndices(outgoing_, 3 * triangles)) {
    archive.Fail("is no mesh within its capacity");
    return;
  }
  positions_ = rest_;
  journal_.clear();
  is_touched_.assign(triangles, 0);
  ClearJournal();
}

void VisitState(base::StateArchive& archive, VertexSource& source) {
  archive.Field("origin", source.origin);
  archive.Field("from", source.from);
  archive.Field("weights", source.weights);
}

}  // namespace trocar::geometry
