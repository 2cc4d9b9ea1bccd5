// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/pattern_cut_monitor.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {
namespace {

using geometry::EditableMesh;
using geometry::kNone;

constexpr double kOnBorder = 1e-6;  // [m]

/// Between a circle about the origin and an edge, as far as the edge is seen from there: its angle times half the difference of
/// the squared distances [m^2].
double CalcAreaOff(const math::Vec3& a, const math::Vec3& b, double radius) noexcept {
  const double angle = math::Atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
  const double squared =
      math::SquaredNorm(a + b) / 4 + math::SquaredDistance(a, b) / 12;  // mean along the edge
  return 0.5 * std::fabs(angle * (squared - radius * radius));
}

}  // namespace

PatternCutMonitor::PatternCutMonitor(const PatternSheet& sheet, const EditableMesh& mesh)
    : sheet_(sheet), piece_(mesh.TriangleCapacity(), 0) {
  stack_.reserve(mesh.TriangleCapacity());
  const auto rest = mesh.Rest();
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    if (math::SquaredDistance(rest[v], sheet_.centre) < math::SquaredDistance(rest[centre_], sheet_.centre))
      centre_ = v;
  }
}

bool PatternCutMonitor::IsBorder(const math::Vec3& p_rest) const noexcept {
  const math::Vec3 d = p_rest - sheet_.centre;
  return std::fabs(d.x) >= sheet_.half.x - kOnBorder || std::fabs(d.y) >= sheet_.half.y - kOnBorder;
}

/// Finds what hangs together with the middle, and whether the border is part of it.
void PatternCutMonitor::MarkPiece(const EditableMesh& mesh) noexcept {
  std::fill(piece_.begin(), piece_.end(), std::uint8_t{0});
  stack_.clear();
  const auto visit = [&](std::uint32_t h) {
    if (h == kNone || piece_[EditableMesh::TriangleOf(h)] != 0) return;
    piece_[EditableMesh::TriangleOf(h)] = 1;
    stack_.push_back(EditableMesh::TriangleOf(h));
  };
  now_.is_free = true;
  visit(mesh.Outgoing(centre_));
  while (!stack_.empty()) {
    const std::uint32_t t = stack_.back();
    stack_.pop_back();
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (IsBorder(mesh.Rest()[mesh.Triangles()[t][i]])) now_.is_free = false;
      visit(mesh.Twin(3 * t + i));
    }
  }
}

void PatternCutMonitor::Update(const EditableMesh& mesh) noexcept {
  MarkPiece(mesh);
  now_.cut_length = now_.off_area = now_.farthest = 0;
  for (std::uint32_t h = 0; h < 3 * mesh.TriangleCount(); ++h) {
    if (mesh.Twin(h) != kNone) continue;
    const math::Vec3 &a = mesh.Rest()[mesh.From(h)], &b = mesh.Rest()[mesh.To(h)];
    const math::Vec3 middle = 0.5 * (a + b);
    if (IsBorder(middle)) continue;
    const double length = math::Distance(a, b);
    now_.cut_length += 0.5 * length;  // a cut has two sides
    const double outside = math::Distance(middle, sheet_.centre) - sheet_.circle;
    const bool is_rim = now_.is_free && piece_[EditableMesh::TriangleOf(h)] != 0;
    if (is_rim) now_.off_area += CalcAreaOff(a - sheet_.centre, b - sheet_.centre, sheet_.circle);
    if (!(is_rim || outside < 0) || !(std::fabs(outside) > now_.farthest)) continue;
    now_.farthest = std::fabs(outside);
    now_.p_farthest = middle;
  }
}

void PatternCutMonitor::VisitState(base::StateArchive& archive) {
  archive.Field("cut_length", now_.cut_length);
  archive.Field("farthest", now_.farthest);
  archive.Field("off_area", now_.off_area);
  archive.Field("is_free", now_.is_free);
  archive.Field("p_farthest", now_.p_farthest);
}

}  // namespace trocar::surgery
