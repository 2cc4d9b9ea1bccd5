// SPDX-License-Identifier: Apache-2.0
#include "sliver_removal.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "surface_edits.h"
#include "trocar/math/elementary.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::meshing {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

/// Angles up to this count as too small while a patch is improved: a margin above any sliver [rad].
constexpr double kGoalAngle = 10.0 * math::kDegree;
/// A patch is done when its angles are this much above a sliver's [rad].
constexpr double kMargin = 1.0 * math::kDegree;
/// Trial steps of a vertex, in mean lengths of its edges.
constexpr double kSteps[] = {0.05, 0.12, 0.25, 0.45};
/// A step along the normal changes the shape: it must gain so many times as much as one along the surface.
constexpr double kNormalStepsWorth = 0.5;
/// Edits of one patch in one pass, at most; and the share of its shortfall that an edit must gain.
constexpr int kMostEdits = 60;
constexpr double kLeastGain = 0.005;

/// Sum of the squared shortfalls of angles [rad^2].
double CalcShortfall(const std::vector<PlacedTriangle>& triangles) {
  double sum = 0;
  for (const PlacedTriangle& t : triangles) {
    const double missing = std::max(0.0, kGoalAngle - SurfaceEdits::AngleOf(t));
    sum += missing * missing;
  }
  return sum;
}

class SliverRemover {
 public:
  SliverRemover(const TriangleMesh& mesh, const SliverSettings& settings)
      : edits_(mesh), settings_(settings), least_angle_(settings.least_angle_deg * math::kDegree) {}

  void Run() {
    for (int pass = 0; pass < settings_.passes; ++pass) {
      bool is_changed = false;
      for (std::uint32_t t = 0; t < Surface().TriangleSlots(); ++t) {
        if (Surface().IsAlive(t) && AngleOf(t) < least_angle_) is_changed |= ImprovePatch(t);
      }
      if (!is_changed) return;
    }
  }

  TriangleMesh Take() const { return Surface().Take(); }

 private:
  const EditableSurface& Surface() const { return edits_.Surface(); }
  double AngleOf(std::uint32_t t) const { return SurfaceEdits::AngleOf(edits_.Place(t)); }

  /// The triangle's corners and their neighbours, ascending.
  std::vector<std::uint32_t> FindPatch(std::uint32_t t) const {
    std::vector<std::uint32_t> patch;
    for (const auto corner : Surface().TriangleAt(t)) {
      Surface().GatherNeighbours(corner, ring_);
      patch.insert(patch.end(), ring_.begin(), ring_.end());
    }
    std::sort(patch.begin(), patch.end());
    patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
    return patch;
  }
  std::vector<std::uint32_t> FindTriangles(const std::vector<std::uint32_t>& patch) const {
    std::vector<std::uint32_t> triangles;
    for (const auto v : patch)
      triangles.insert(triangles.end(), Surface().Around(v).begin(), Surface().Around(v).end());
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    return triangles;
  }
  bool IsDone(const std::vector<std::uint32_t>& patch) const {
    const auto triangles = FindTriangles(patch);
    return std::none_of(triangles.begin(), triangles.end(),
                        [&](std::uint32_t t) { return AngleOf(t) < least_angle_ + kMargin; });
  }

  /// Makes the edit that gains most around the sliver, again and again.
  bool ImprovePatch(std::uint32_t sliver) {
    const auto patch = FindPatch(sliver);
    bool is_changed = false;
    for (int i = 0; i < kMostEdits && !IsDone(patch); ++i) {
      const auto edit = FindBestEdit(patch);
      if (!edit) break;
      edits_.Make(*edit);
      is_changed = true;
    }
    return is_changed;
  }

  std::optional<Edit> FindBestEdit(const std::vector<std::uint32_t>& patch) const {
    std::optional<Edit> best;
    double best_gain = 0;
    const auto consider = [&](Edit edit, double worth) {
      const auto before = edits_.PlaceBefore(edit);
      const double shortfall = CalcShortfall(before);
      const double gain = worth * (shortfall - CalcShortfall(edit.changed));
      if (!(gain > best_gain) || gain < kLeastGain * shortfall || edits_.Folds(edit, before)) return;
      // the costly part last
      if (edits_.CountCuts(edit.changed, edit) > edits_.CountCuts(before, edit)) return;
      best = std::move(edit);
      best_gain = gain;
    };
    for (const auto v : patch) {
      if (!Surface().Around(v).empty()) ConsiderMoves(v, consider);
    }
    for (const auto t : FindTriangles(patch)) {
      for (int side = 0; side < 3; ++side) {
        const EdgeNeighbours edge = Surface().FindAcross(t, side);
        if (edge.a > edge.b) continue;  // the triangle across has it too
        if (Surface().CanFlip(edge)) consider(edits_.MakeFlip(edge), 1.0);
        ConsiderCollapses(edge.a, edge.b, consider);
      }
    }
    return best;
  }

  /// Steps of a vertex along the surface, in eight directions, and along its normal.
  template <typename Consider>
  void ConsiderMoves(std::uint32_t v, const Consider& consider) const {
    const Vec3& p = Surface().Position(v);
    Vec3 normal;
    double length = 0;
    bool is_small = false;
    for (const auto t : Surface().Around(v)) {
      normal += Surface().AreaNormal(Surface().TriangleAt(t));
      is_small |= AngleOf(t) < kGoalAngle;
    }
    if (!is_small) return;  // nothing to gain
    normal = math::Normalized(normal);
    Surface().GatherNeighbours(v, ring_);
    for (const auto w : ring_)
      length += Distance(Surface().Position(w), p) / static_cast<double>(ring_.size());
    const Vec3 any = std::fabs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = math::Normalized(Cross(normal, any)), w = Cross(normal, u);
    for (const double step : kSteps) {
      for (int i = 0; i < 8; ++i) {
        const double angle = i * M_PI / 4;
        consider(edits_.MakeMove(v, p + step * length * (math::Cos(angle) * u + math::Sin(angle) * w)), 1.0);
      }
      for (const double side : {-1.0, 1.0})
        consider(edits_.MakeMove(v, p + side * step * length * normal), kNormalStepsWorth);
    }
  }

  template <typename Consider>
  void ConsiderCollapses(std::uint32_t a, std::uint32_t b, const Consider& consider) const {
    if (Surface().TriangleCount() < settings_.fewest_triangles + 2 || !Surface().CanCollapse(a, b)) return;
    for (const double part : {0.5, 0.0, 1.0})
      consider(edits_.MakeCollapse(a, b, math::Lerp(Surface().Position(a), Surface().Position(b), part)),
               1.0);
  }

  SurfaceEdits edits_;
  SliverSettings settings_;
  double least_angle_;
  mutable std::vector<std::uint32_t> ring_;  // scratch
};

}  // namespace

std::size_t CountSlivers(const TriangleMesh& mesh, double least_angle_deg) {
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const geometry::Triangle& t) {
        return geometry::CalcSmallestAngle(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) <
               least_angle_deg * math::kDegree;
      }));
}

std::size_t RemoveSlivers(TriangleMesh& mesh, const SliverSettings& settings) {
  if (CountSlivers(mesh, settings.least_angle_deg) == 0) return 0;
  SliverRemover remover(mesh, settings);
  remover.Run();
  mesh = remover.Take();
  return CountSlivers(mesh, settings.least_angle_deg);
}

}  // namespace trocar::meshing
