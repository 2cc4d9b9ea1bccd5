// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "editable_surface.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::meshing {
namespace {

using geometry::Box;
using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

/// An edit may not leave neighbours whose normals differ more than this (cosine), unless they did before.
constexpr double kFoldCosine = -0.5;
/// Below this a triangle's normal says nothing [rad].
constexpr double kNoNormalAngle = 0.02;
/// How far a vertex may step along its normal, in mean lengths of its edges.
constexpr double kNormalSteps[] = {0.06, -0.06, 0.15, -0.15, 0.3, -0.3};
/// How far it may step towards the middle of its neighbours.
constexpr double kMiddleSteps[] = {0.5, 1.0};

/// A triangle where an edit would put it.
struct PlacedTriangle {
  std::uint32_t index = 0;
  Triangle triangle{};
  std::array<Vec3, 3> corners;
  Box box;
};

/// One local edit, not yet made: these triangles change, those vanish.
struct Edit {
  enum class Kind { kMove, kFlip, kCollapse };
  Kind kind = Kind::kMove;
  std::uint32_t a = 0, b = 0;  // vertices
  Vec3 point;                  // where a goes
  EdgeNeighbours edge;         // of a flip
  std::vector<PlacedTriangle> changed;
  std::vector<std::uint32_t> removed;
};

/// Defects among some triangles, and between them and all others.
struct Score {
  std::size_t cuts = 0, slivers = 0;
  double angle = M_PI;  // smallest [rad]

  bool operator<(const Score& other) const {
    if (cuts != other.cuts) return cuts < other.cuts;
    if (slivers != other.slivers) return slivers < other.slivers;
    return angle > other.angle;
  }
};

class Repairer {
 public:
  Repairer(const TriangleMesh& mesh, const RepairSettings& settings)
      : surface_(mesh), settings_(settings), least_angle_(settings.min_angle_deg * M_PI / 180.0) {
    for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t)
      boxes_.push_back(Place(t, surface_.TriangleAt(t)).box);
  }

  RepairReport Run() {
    for (int round = 0; round < settings_.rounds; ++round) {
      bool is_changed = false;
      for (const auto& [first, second] : FindCuts()) {
        // an edit for an earlier pair may have helped this one
        if (!surface_.IsAlive(first) || !surface_.IsAlive(second) || !AreCutting(first, second)) continue;
        is_changed |= Improve({first, second}, true);
      }
      for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t) {
        if (surface_.IsAlive(t) && IsSliver(t)) is_changed |= Improve({t}, false);
      }
      if (!is_changed) break;
    }
    report_.self_intersections = FindCuts().size();
    for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t)
      report_.slivers += surface_.IsAlive(t) && IsSliver(t) ? 1 : 0;
    return report_;
  }

  TriangleMesh Take() const { return surface_.Take(); }

 private:
  PlacedTriangle Place(std::uint32_t index, const Triangle& t) const {
    PlacedTriangle placed{
        index, t, {surface_.Position(t[0]), surface_.Position(t[1]), surface_.Position(t[2])}, {}};
    placed.box = geometry::CalcBox(placed.corners);
    return placed;
  }
  double AngleOf(const PlacedTriangle& t) const {
    return geometry::CalcSmallestAngle(t.corners[0], t.corners[1], t.corners[2]);
  }
  bool IsSliver(std::uint32_t t) const { return AngleOf(Place(t, surface_.TriangleAt(t))) < least_angle_; }
  static bool Cut(const PlacedTriangle& a, const PlacedTriangle& b) {
    return geometry::BoxesOverlap(a.box, b.box) &&
           geometry::TrianglesCut(a.triangle, a.corners.data(), b.triangle, b.corners.data());
  }
  bool AreCutting(std::uint32_t t, std::uint32_t u) const {
    return Cut(Place(t, surface_.TriangleAt(t)), Place(u, surface_.TriangleAt(u)));
  }

  std::vector<std::array<std::uint32_t, 2>> FindCuts() const {
    TriangleMesh alive;
    std::vector<std::uint32_t> index;
    for (std::uint32_t v = 0; v < surface_.VertexSlots(); ++v)
      alive.positions.push_back(surface_.Position(v));
    for (std::uint32_t t = 0; t < surface_.TriangleSlots(); ++t) {
      if (!surface_.IsAlive(t)) continue;
      alive.triangles.push_back(surface_.TriangleAt(t));
      index.push_back(t);
    }
    auto pairs = geometry::FindSelfIntersections(alive);
    for (auto& [first, second] : pairs) first = index[first], second = index[second];
    return pairs;
  }

  /// Makes the best edit around some triangles, if there is one that helps.
  bool Improve(const std::vector<std::uint32_t>& defects, bool is_cut) {
    std::optional<Edit> best;
    Score best_score;
    const auto consider = [&](Edit edit) {
      const auto before = PlaceBefore(edit);
      if (FindFold(edit.changed, edit) < std::min(kFoldCosine, FindFold(before, edit))) return;
      Score old_score = CountSlivers(before), score = CountSlivers(edit.changed);
      if (score.slivers > old_score.slivers) return;
      if (!is_cut && score.slivers == old_score.slivers && score.angle <= 1.05 * old_score.angle) return;
      if (best && !is_cut && best_score.cuts == 0 && !(score < best_score)) return;
      // the costly part last
      score.cuts = CountCuts(edit.changed, edit);
      if (best && !(score < best_score)) return;
      old_score.cuts = CountCuts(before, edit);
      if (is_cut ? score.cuts >= old_score.cuts : score.cuts > old_score.cuts) return;
      best = std::move(edit);
      best_score = score;
    };
    for (const auto t : defects) {
      for (int i = 0; i < 3; ++i) ConsiderEdits(t, i, is_cut, consider);
    }
    if (!best) return false;
    Make(*best);
    return true;
  }

  template <typename Consider>
  void ConsiderEdits(std::uint32_t t, int i, bool is_cut, const Consider& consider) const {
    const EdgeNeighbours edge = surface_.FindAcross(t, i);
    if (surface_.CanFlip(edge)) consider(MakeFlip(edge));
    const Vec3 &p = surface_.Position(edge.a), &q = surface_.Position(edge.b);
    if (surface_.TriangleCount() >= settings_.fewest_triangles + 2 && surface_.CanCollapse(edge.a, edge.b)) {
      for (const double part : {0.5, 0.0, 1.0})
        consider(MakeCollapse(edge.a, edge.b, math::Lerp(p, q, part)));
    }
    // moves of the corner that the side starts from
    Vec3 middle, normal;
    double length = 0;
    surface_.GatherNeighbours(edge.a, ring_);
    const auto count = static_cast<double>(ring_.size());
    for (const auto w : ring_) {
      middle += surface_.Position(w) / count;
      length += Distance(surface_.Position(w), p) / count;
    }
    for (const auto u : surface_.Around(edge.a)) normal += surface_.AreaNormal(surface_.TriangleAt(u));
    normal = math::Normalized(normal);
    const Vec3 away = middle - p, along = away - Dot(away, normal) * normal;
    for (const double step : kMiddleSteps) consider(MakeMove(edge.a, p + step * along));
    if (!is_cut) return;
    for (const double step : kMiddleSteps) consider(MakeMove(edge.a, p + step * away));
    for (const double step : kNormalSteps) consider(MakeMove(edge.a, p + step * length * normal));
  }

  Edit MakeMove(std::uint32_t v, const Vec3& p) const {
    Edit edit;
    edit.kind = Edit::Kind::kMove, edit.a = v, edit.point = p;
    for (const auto t : surface_.Around(v))
      edit.changed.push_back(PlaceWith(t, surface_.TriangleAt(t), v, p));
    return edit;
  }
  Edit MakeFlip(const EdgeNeighbours& edge) const {
    Edit edit;
    edit.kind = Edit::Kind::kFlip, edit.edge = edge;
    edit.changed = {Place(edge.t, edge.FlippedFirst()), Place(edge.other, edge.FlippedSecond())};
    return edit;
  }
  Edit MakeCollapse(std::uint32_t a, std::uint32_t b, const Vec3& p) const {
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
  PlacedTriangle PlaceWith(std::uint32_t index, const Triangle& t, std::uint32_t v, const Vec3& p) const {
    PlacedTriangle placed = Place(index, t);
    for (int i = 0; i < 3; ++i) {
      if (t[i] == v) placed.corners[i] = p;
    }
    placed.box = geometry::CalcBox(placed.corners);
    return placed;
  }

  std::vector<PlacedTriangle> PlaceBefore(const Edit& edit) const {
    std::vector<PlacedTriangle> before;
    for (const PlacedTriangle& t : edit.changed)
      before.push_back(Place(t.index, surface_.TriangleAt(t.index)));
    for (const auto t : edit.removed) before.push_back(Place(t, surface_.TriangleAt(t)));
    return before;
  }
  static bool Touches(const Edit& edit, std::uint32_t t) {
    return std::any_of(edit.changed.begin(), edit.changed.end(),
                       [&](const auto& c) { return c.index == t; }) ||
           std::find(edit.removed.begin(), edit.removed.end(), t) != edit.removed.end();
  }

  Score CountSlivers(const std::vector<PlacedTriangle>& triangles) const {
    Score score;
    for (const PlacedTriangle& t : triangles) {
      const double angle = AngleOf(t);
      score.slivers += angle < least_angle_ ? 1 : 0;
      score.angle = std::min(score.angle, angle);
    }
    return score;
  }

  std::size_t CountCuts(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const {
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

  /// Smallest cosine between the normals of two of the triangles, or one of them and one beside, that share a
  /// side.
  double FindFold(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const {
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
          shared +=
              std::find(local[k].triangle.begin(), local[k].triangle.end(), v) != local[k].triangle.end();
        if (shared == 2) fold = std::min(fold, Dot(normals[i], normals[k]));
      }
    }
    return fold;
  }

  void Make(const Edit& edit) {
    switch (edit.kind) {
      case Edit::Kind::kMove:
        surface_.Move(edit.a, edit.point);
        ++report_.moves;
        break;
      case Edit::Kind::kFlip:
        surface_.Flip(edit.edge);
        ++report_.flips;
        break;
      case Edit::Kind::kCollapse:
        surface_.Collapse(edit.a, edit.b, edit.point);
        ++report_.collapses;
        break;
    }
    for (const PlacedTriangle& t : edit.changed) boxes_[t.index] = t.box;
  }

  EditableSurface surface_;
  RepairSettings settings_;
  double least_angle_;
  std::vector<Box> boxes_;
  RepairReport report_;
  mutable std::vector<std::uint32_t> ring_;  // scratch
};

}  // namespace

RepairReport RepairMesh(TriangleMesh& mesh, const RepairSettings& settings) {
  Repairer repairer(mesh, settings);
  const RepairReport report = repairer.Run();
  if (report.flips + report.collapses + report.moves > 0) mesh = repairer.Take();
  return report;
}

}  // namespace trocar::meshing
