// SPDX-License-Identifier: Apache-2.0
#include "surface_edits.h"

#include <algorithm>

namespace trocar::meshing {
namespace {

using geometry::Box;
using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

/// Below this a triangle's normal says nothing [rad].
constexpr double kNoNormalAngle = 0.02;

bool Cut(const PlacedTriangle& a, const PlacedTriangle& b) {
  return geometry::BoxesOverlap(a.box, b.box) &&
         geometry::TrianglesCut(a.triangle, a.corners.data(), b.triangle, b.corners.data());
}

bool Touches(const Edit& edit, std::uint32_t t) {
  return std::any_of(edit.changed.begin(), edit.changed.end(), [&](const auto& c) { return c.index == t; }) ||
         std::find(edit.removed.begin(), edit.removed.end(), t) != edit.removed.end();
}

}  // namespace

SurfaceEdits::SurfaceEdits(const TriangleMesh& mesh) : surface_(mesh) {
  boxes_.reserve(surface_.TriangleSlots());
  for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t) boxes_.push_back(Place(t).box);
}

PlacedTriangle SurfaceEdits::Place(std::uint32_t index, const Triangle& t) const {
  PlacedTriangle placed{
      index, t, {surface_.Position(t[0]), surface_.Position(t[1]), surface_.Position(t[2])}, {}};
  placed.box = geometry::CalcBox(placed.corners);
  return placed;
}

bool SurfaceEdits::AreCutting(std::uint32_t t, std::uint32_t u) const {
  return Cut(Place(t, surface_.TriangleAt(t)), Place(u, surface_.TriangleAt(u)));
}

std::vector<std::array<std::uint32_t, 2>> SurfaceEdits::FindCuts() const {
  TriangleMesh alive;
  std::vector<std::uint32_t> index;
  for (std::uint32_t v = 0; v < surface_.VertexSlots(); ++v) alive.positions.push_back(surface_.Position(v));
  for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t) {
    if (!surface_.IsAlive(t)) continue;
    alive.triangles.push_back(surface_.TriangleAt(t));
    index.push_back(t);
  }
  auto pairs = geometry::FindSelfIntersections(alive);
  for (auto& [first, second] : pairs) first = index[first], second = index[second];
  return pairs;
}

Edit SurfaceEdits::MakeMove(std::uint32_t v, const Vec3& p) const {
  Edit edit;
  edit.kind = Edit::Kind::kMove, edit.a = v, edit.point = p;
  for (const auto t : surface_.Around(v)) edit.changed.push_back(PlaceWith(t, surface_.TriangleAt(t), v, p));
  return edit;
}

Edit SurfaceEdits::MakeFlip(const EdgeNeighbours& edge) const {
  Edit edit;
  edit.kind = Edit::Kind::kFlip, edit.edge = edge;
  edit.changed = {Place(edge.t, edge.FlippedFirst()), Place(edge.other, edge.FlippedSecond())};
  return edit;
}

Edit SurfaceEdits::MakeCollapse(std::uint32_t a, std::uint32_t b, const Vec3& p) const {
  Edit edit;
  edit.kind = Edit::Kind::kCollapse, edit.a = a, edit.b = b, edit.point = p;
  for (const auto t : surface_.Around(a)) {
    const Triangle& triangle = surface_.TriangleAt(t);
    if (std::find(triangle.begin(), triangle.end(), b) != triangle.end())
      edit.removed.push_back(t);
    else
      edit.changed.push_back(PlaceWith(t, triangle, a, p));
  }
  for (const auto t : surface_.Around(b)) {
    Triangle triangle = surface_.TriangleAt(t);
    if (std::find(triangle.begin(), triangle.end(), a) != triangle.end()) continue;
    std::replace(triangle.begin(), triangle.end(), b, a);
    edit.changed.push_back(PlaceWith(t, triangle, a, p));
  }
  return edit;
}

PlacedTriangle SurfaceEdits::PlaceWith(std::uint32_t index, const Triangle& t, std::uint32_t v,
                                       const Vec3& p) const {
  PlacedTriangle placed = Place(index, t);
  for (int i = 0; i < 3; ++i) {
    if (t[i] == v) placed.corners[i] = p;
  }
  placed.box = geometry::CalcBox(placed.corners);
  return placed;
}

std::vector<PlacedTriangle> SurfaceEdits::PlaceBefore(const Edit& edit) const {
  std::vector<PlacedTriangle> before;
  for (const PlacedTriangle& t : edit.changed) before.push_back(Place(t.index, surface_.TriangleAt(t.index)));
  for (const auto t : edit.removed) before.push_back(Place(t, surface_.TriangleAt(t)));
  return before;
}

std::size_t SurfaceEdits::CountCuts(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const {
  Box all = triangles.front().box;
  for (const PlacedTriangle& t : triangles)
    all.min = math::Min(all.min, t.box.min), all.max = math::Max(all.max, t.box.max);
  std::size_t cuts = 0;
  for (std::uint32_t u = 0; u < boxes_.size(); ++u) {
    if (!geometry::BoxesOverlap(all, boxes_[u]) || !surface_.IsAlive(u) || Touches(edit, u)) continue;
    const PlacedTriangle other = Place(u, surface_.TriangleAt(u));
    for (const PlacedTriangle& t : triangles) cuts += Cut(t, other) ? 1 : 0;
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = i + 1; k < triangles.size(); ++k) cuts += Cut(triangles[i], triangles[k]) ? 1 : 0;
  }
  return cuts;
}

double SurfaceEdits::FindFold(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const {
  std::vector<PlacedTriangle> local = triangles;
  for (const PlacedTriangle& t : triangles) {
    for (const auto v : t.triangle) {
      for (const auto u : surface_.Around(v)) {
        const bool is_known =
            std::any_of(local.begin(), local.end(), [&](const auto& known) { return known.index == u; });
        if (!is_known && !Touches(edit, u)) local.push_back(Place(u, surface_.TriangleAt(u)));
      }
    }
  }
  const auto normal_of = [&](const PlacedTriangle& t) {
    if (AngleOf(t) < kNoNormalAngle) return Vec3{};
    return math::Normalized(Cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
  };
  std::vector<Vec3> normals;
  for (const PlacedTriangle& t : local) normals.push_back(normal_of(t));
  double fold = 1.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = i + 1; k < local.size(); ++k) {
      int shared = 0;
      for (const auto v : local[i].triangle)
        shared += std::find(local[k].triangle.begin(), local[k].triangle.end(), v) != local[k].triangle.end();
      if (shared == 2) fold = std::min(fold, Dot(normals[i], normals[k]));
    }
  }
  return fold;
}

bool SurfaceEdits::Folds(const Edit& edit, const std::vector<PlacedTriangle>& before) const {
  return FindFold(edit.changed, edit) < std::min(kFoldCosine, FindFold(before, edit));
}

void SurfaceEdits::Make(const Edit& edit) {
  switch (edit.kind) {
    case Edit::Kind::kMove:
      surface_.Move(edit.a, edit.point);
      break;
    case Edit::Kind::kFlip:
      surface_.Flip(edit.edge);
      break;
    case Edit::Kind::kCollapse:
      surface_.Collapse(edit.a, edit.b, edit.point);
      break;
  }
  for (const PlacedTriangle& t : edit.changed) boxes_[t.index] = t.box;
}

}  // namespace trocar::meshing
