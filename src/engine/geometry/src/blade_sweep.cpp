// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/blade_sweep.h"

#include <algorithm>
#include <cmath>

namespace trocar::geometry {

using math::Vec3;

namespace {

/// Farthest that the corners of a quadrilateral may lie off its plane, as a share of its diagonal [-].
constexpr double kFlatness = 1e-6;
/// Areas below this share of the longest side's square are none [-].
constexpr double kLeastArea = 1e-12;
/// Points this near to a border count as in, as a share of the longest side [-].
constexpr double kBorder = 1e-9;

double CalcSize(const FlatSweep& sweep) {
  double size = 0;
  for (std::size_t i = 0; i < sweep.count; ++i)
    size = std::max(size, math::Distance(sweep.corners[i], sweep.corners[(i + 1) % sweep.count]));
  return size;
}

std::optional<FlatSweep> MakeTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  FlatSweep sweep{{a, b, c, c}, 3, {}};
  const Vec3 normal = math::Cross(b - a, c - a);
  const double size = CalcSize(sweep), area = math::Norm(normal);
  if (!(area > kLeastArea * size * size)) return std::nullopt;
  sweep.normal = normal / area;
  return sweep;
}

/// A flat convex quadrilateral, or nothing.
std::optional<FlatSweep> MakeQuad(const std::array<Vec3, 4>& corners) {
  const Vec3 normal = math::Cross(corners[2] - corners[0], corners[3] - corners[1]);
  const double area = math::Norm(normal);
  FlatSweep sweep{corners, 4, {}};
  const double size = CalcSize(sweep);
  if (!(area > kLeastArea * size * size)) return std::nullopt;
  sweep.normal = normal / area;
  for (std::size_t i = 0; i < 4; ++i) {
    if (std::fabs(sweep.Height(corners[i])) > kFlatness * size) return std::nullopt;
    const Vec3 turn =
        math::Cross(corners[(i + 1) % 4] - corners[i], corners[(i + 2) % 4] - corners[(i + 1) % 4]);
    if (!(math::Dot(turn, sweep.normal) > kLeastArea * size * size)) return std::nullopt;
  }
  return sweep;
}

}  // namespace

BladeMoves MakeFlatMoves(const BladeEdge& before, const BladeEdge& now) noexcept {
  BladeMoves moves;
  if (const auto quad = MakeQuad({before.a, before.b, now.b, now.a})) {
    moves.moves[moves.count++] = {before, now, *quad};
    return moves;
  }
  const bool b_goes_first = math::SquaredDistance(before.a, now.b) <= math::SquaredDistance(before.b, now.a);
  const BladeEdge between = b_goes_first ? BladeEdge{before.a, now.b} : BladeEdge{now.a, before.b};
  const auto first = MakeTriangle(before.a, before.b, b_goes_first ? now.b : now.a);
  if (first) moves.moves[moves.count++] = {before, between, *first};
  const auto second = MakeTriangle(b_goes_first ? before.a : before.b, now.a, now.b);
  if (second) moves.moves[moves.count++] = {between, now, *second};
  return moves;
}

std::optional<FlatSweep> MakeFlatSweep(const Vec3& tip, const BladeEdge& blade) noexcept {
  return MakeTriangle(tip, blade.a, blade.b);
}

Box CalcBox(const FlatSweep& sweep) noexcept {
  Box box{sweep.corners[0], sweep.corners[0]};
  for (std::size_t i = 1; i < sweep.count; ++i) {
    box.min = math::Min(box.min, sweep.corners[i]);
    box.max = math::Max(box.max, sweep.corners[i]);
  }
  return box;
}

bool Contains(const FlatSweep& sweep, const Vec3& p) noexcept {
  const double border = kBorder * CalcSize(sweep);
  for (std::size_t i = 0; i < sweep.count; ++i) {
    const Vec3 side = sweep.corners[(i + 1) % sweep.count] - sweep.corners[i];
    if (math::Dot(math::Cross(side, p - sweep.corners[i]), sweep.normal) < -border * math::Norm(side))
      return false;
  }
  return true;
}

std::optional<double> FindCrossing(const FlatSweep& sweep, const Vec3& a, const Vec3& b) noexcept {
  const double height_a = sweep.Height(a), height_b = sweep.Height(b);
  if (height_a == height_b || (height_a > 0.0 && height_b > 0.0) || (height_a < 0.0 && height_b < 0.0))
    return std::nullopt;
  const double t = height_a / (height_a - height_b);
  if (!(t >= 0.0 && t <= 1.0) || !Contains(sweep, math::Lerp(a, b, t))) return std::nullopt;
  return t;
}

std::optional<Vec3> FindPiercing(const BladeEdge& segment, const Vec3& a, const Vec3& b,
                                 const Vec3& c) noexcept {
  const auto triangle = MakeTriangle(a, b, c);
  if (!triangle) return std::nullopt;
  const auto t = FindCrossing(*triangle, segment.a, segment.b);
  if (!t) return std::nullopt;
  return math::Lerp(segment.a, segment.b, *t);
}

}  // namespace trocar::geometry
