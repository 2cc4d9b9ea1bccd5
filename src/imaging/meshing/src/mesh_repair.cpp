// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "surface_edits.h"

namespace trocar::meshing {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

/// How far a vertex may step along its normal, in mean lengths of its edges.
constexpr double kNormalSteps[] = {0.06, -0.06, 0.15, -0.15, 0.3, -0.3};
/// How far it may step towards the middle of its neighbours.
constexpr double kMiddleSteps[] = {0.5, 1.0};

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
      : edits_(mesh), settings_(settings), least_angle_(settings.min_angle_deg * M_PI / 180.0) {}

  RepairReport Run() {
    for (int round = 0; round < settings_.rounds; ++round) {
      bool is_changed = false;
      for (const auto& [first, second] : edits_.FindCuts()) {
        // an edit for an earlier pair may have helped this one
        if (!Surface().IsAlive(first) || !Surface().IsAlive(second) || !edits_.AreCutting(first, second))
          continue;
        is_changed |= Improve({first, second}, true);
      }
      for (std::uint32_t t = 0; t < Surface().TriangleSlots(); ++t) {
        if (Surface().IsAlive(t) && IsSliver(t)) is_changed |= Improve({t}, false);
      }
      if (!is_changed) break;
    }
    report_.self_intersections = edits_.FindCuts().size();
    for (std::uint32_t t = 0; t < Surface().TriangleSlots(); ++t)
      report_.slivers += Surface().IsAlive(t) && IsSliver(t) ? 1 : 0;
    return report_;
  }

  TriangleMesh Take() const { return Surface().Take(); }

 private:
  const EditableSurface& Surface() const { return edits_.Surface(); }
  bool IsSliver(std::uint32_t t) const { return SurfaceEdits::AngleOf(edits_.Place(t)) < least_angle_; }

  /// Makes the best edit around some triangles, if there is one that helps.
  bool Improve(const std::vector<std::uint32_t>& defects, bool is_cut) {
    std::optional<Edit> best;
    Score best_score;
    const auto consider = [&](Edit edit) {
      const auto before = edits_.PlaceBefore(edit);
      if (edits_.Folds(edit, before)) return;
      Score old_score = CountSlivers(before), score = CountSlivers(edit.changed);
      if (score.slivers > old_score.slivers) return;
      if (!is_cut && score.slivers == old_score.slivers && score.angle <= 1.05 * old_score.angle) return;
      if (best && !is_cut && best_score.cuts == 0 && !(score < best_score)) return;
      // the costly part last
      score.cuts = edits_.CountCuts(edit.changed, edit);
      if (best && !(score < best_score)) return;
      old_score.cuts = edits_.CountCuts(before, edit);
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
    const EdgeNeighbours edge = Surface().FindAcross(t, i);
    if (Surface().CanFlip(edge)) consider(edits_.MakeFlip(edge));
    const Vec3 &p = Surface().Position(edge.a), &q = Surface().Position(edge.b);
    if (Surface().TriangleCount() >= settings_.fewest_triangles + 2 &&
        Surface().CanCollapse(edge.a, edge.b)) {
      for (const double part : {0.5, 0.0, 1.0})
        consider(edits_.MakeCollapse(edge.a, edge.b, math::Lerp(p, q, part)));
    }
    // moves of the corner that the side starts from
    Vec3 middle, normal;
    double length = 0;
    Surface().GatherNeighbours(edge.a, ring_);
    const auto count = static_cast<double>(ring_.size());
    for (const auto w : ring_) {
      middle += Surface().Position(w) / count;
      length += Distance(Surface().Position(w), p) / count;
    }
    for (const auto u : Surface().Around(edge.a)) normal += Surface().AreaNormal(Surface().TriangleAt(u));
    normal = math::Normalized(normal);
    const Vec3 away = middle - p, along = away - Dot(away, normal) * normal;
    for (const double step : kMiddleSteps) consider(edits_.MakeMove(edge.a, p + step * along));
    if (!is_cut) return;
    for (const double step : kMiddleSteps) consider(edits_.MakeMove(edge.a, p + step * away));
    for (const double step : kNormalSteps) consider(edits_.MakeMove(edge.a, p + step * length * normal));
  }

  Score CountSlivers(const std::vector<PlacedTriangle>& triangles) const {
    Score score;
    for (const PlacedTriangle& t : triangles) {
      const double angle = SurfaceEdits::AngleOf(t);
      score.slivers += angle < least_angle_ ? 1 : 0;
      score.angle = std::min(score.angle, angle);
    }
    return score;
  }

  void Make(const Edit& edit) {
    edits_.Make(edit);
    report_.moves += edit.kind == Edit::Kind::kMove;
    report_.flips += edit.kind == Edit::Kind::kFlip;
    report_.collapses += edit.kind == Edit::Kind::kCollapse;
  }

  SurfaceEdits edits_;
  RepairSettings settings_;
  double least_angle_;
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
