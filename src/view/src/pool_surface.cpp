// SPDX-License-Identifier: Apache-2.0
#include "pool_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trocar/core/assert.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kSpacing = 0.0013;   // m between points of the lattice
constexpr double kMargin = 0.004;     // m beyond the puddle's radius
constexpr double kOverhang = 0.003;   // m above the level; higher ground counts where there is no lower
constexpr double kTallest = 0.009;    // m above the level, of an island; what is higher hangs over the pool
constexpr double kLeastSlope = 0.15;  // cosine; a steeper piece holds no liquid
constexpr double kClimb = 0.0006;     // m that surface tension draws the liquid up at its shore
constexpr double kInside = 0.0009, kOutside = 0.0005;  // m of depth over which that fades
constexpr double kFilm = 0.0009;                       // m above the level that is still covered
constexpr double kClear = 0.0008;                      // m of liquid that hide 63 % of what is under it
constexpr double kShoreSlope = 0.6;                    // of an end where there is no ground

constexpr double kUnknown = -std::numeric_limits<double>::infinity();

}  // namespace

double CalcPoolShare(double depth) noexcept {
  return depth > -kFilm ? 1.0 - std::exp(-(depth + kFilm) / kClear) : 0.0;
}

void PoolSurface::Make(const render::Puddle& puddle, const Vec3& lowest,
                       std::span<const GroundShape> ground) {
  mesh_.positions.clear();
  mesh_.triangles.clear();
  rest_.clear();
  shares_.clear();
  depths_.clear();
  if (!(puddle.radius > 0.0)) return;
  up_ = puddle.up;
  right_ = math::AnyPerpendicular(up_);
  ahead_ = math::Cross(up_, right_);
  const double deepest = std::max(0.0, math::Dot(puddle.centre - lowest, up_));
  const int half = static_cast<int>(std::ceil((puddle.radius + kMargin) / kSpacing));
  side_ = 2 * half + 1;
  corner_ = lowest + deepest * up_ - (half * kSpacing) * (right_ + ahead_);
  heights_.assign(At(side_ - 1, side_ - 1) + 1, kUnknown);
  overhangs_.assign(heights_.size(), -kUnknown);
  for (const GroundShape& shape : ground) MeetGround(shape);
  AddVertices(puddle, deepest);
  AddTriangles();
}

/// The highest ground at each point that does not hang over the level.
void PoolSurface::MeetGround(const GroundShape& shape) {
  for (const auto& [ia, ib, ic] : shape.triangles) {
    TROCAR_ASSERT(std::max({ia, ib, ic}) < shape.positions.size());
    const std::array<Vec3, 3> corners = {shape.positions[ia] - corner_, shape.positions[ib] - corner_,
                                         shape.positions[ic] - corner_};
    std::array<double, 3> x{}, y{}, z{};
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = math::Dot(corners[k], right_) / kSpacing;
      y[k] = math::Dot(corners[k], ahead_) / kSpacing;
      z[k] = math::Dot(corners[k], up_);
    }
    const int from_x = std::max(0, static_cast<int>(std::ceil(*std::min_element(x.begin(), x.end()))));
    const int to_x = std::min(side_ - 1, static_cast<int>(std::floor(*std::max_element(x.begin(), x.end()))));
    const int from_y = std::max(0, static_cast<int>(std::ceil(*std::min_element(y.begin(), y.end()))));
    const int to_y = std::min(side_ - 1, static_cast<int>(std::floor(*std::max_element(y.begin(), y.end()))));
    if (from_x > to_x || from_y > to_y) continue;
    const Vec3 normal = math::Cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (math::Dot(normal, up_) < kLeastSlope * math::Norm(normal)) continue;
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (!(area > 0.0)) continue;
    for (int row = from_y; row <= to_y; ++row) {
      for (int column = from_x; column <= to_x; ++column) {
        const double b = ((column - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (row - y[0])) / area;
        const double c = ((x[1] - x[0]) * (row - y[0]) - (column - x[0]) * (y[1] - y[0])) / area;
        if (b < 0.0 || c < 0.0 || b + c > 1.0) continue;
        const double height = z[0] + b * (z[1] - z[0]) + c * (z[2] - z[0]);
        double &known = heights_[At(column, row)], &over = overhangs_[At(column, row)];
        if (height < kOverhang) {
          known = std::max(known, height);
        } else {
          over = std::min(over, height);
        }
      }
    }
  }
}

void PoolSurface::AddVertices(const render::Puddle& puddle, double deepest) {
  vertex_.assign(heights_.size(), -1);
  const double half = 0.5 * (side_ - 1);
  for (int row = 0; row < side_; ++row) {
    for (int column = 0; column < side_; ++column) {
      const double x = (column - half) * kSpacing, y = (row - half) * kSpacing;
      const double side = std::hypot(x, y) / puddle.radius;
      // what stands above the level with nothing under it is ground, too: an island
      double height = heights_[At(column, row)];
      if (height == kUnknown && overhangs_[At(column, row)] < kTallest) height = overhangs_[At(column, row)];
      double depth = height == kUnknown ? deepest * (1.0 - side * side) : -height;
      depth = std::min(depth, kShoreSlope * puddle.radius * (1.0 - side) + kFilm);
      // a lattice point beyond the shore closes the mesh there
      if (depth < -kFilm - kSpacing) continue;
      const double climb = kClimb * std::exp(depth > 0.0 ? -depth / kInside : depth / kOutside);
      vertex_[At(column, row)] = static_cast<std::int32_t>(mesh_.positions.size());
      mesh_.positions.push_back(corner_ + (column * kSpacing) * right_ + (row * kSpacing) * ahead_ +
                                (climb + std::max(0.0, -depth)) * up_);
      rest_.push_back({x, y, 0});
      shares_.push_back(CalcPoolShare(depth));
      depths_.push_back(depth);
    }
  }
}

void PoolSurface::AddTriangles() {
  const auto add = [this](std::int32_t a, std::int32_t b, std::int32_t c) {
    if (a < 0 || b < 0 || c < 0) return;
    const auto at = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    if (shares_[at(a)] + shares_[at(b)] + shares_[at(c)] == 0.0) return;
    mesh_.triangles.push_back({at(a), at(b), at(c)});
  };
  for (int row = 0; row + 1 < side_; ++row) {
    for (int column = 0; column + 1 < side_; ++column) {
      const std::int32_t a = vertex_[At(column, row)], b = vertex_[At(column + 1, row)],
                         c = vertex_[At(column + 1, row + 1)], d = vertex_[At(column, row + 1)];
      // along the other diagonal where a corner is missing
      if (a < 0 || c < 0) {
        add(a, b, d);
        add(b, c, d);
      } else {
        add(a, b, c);
        add(a, c, d);
      }
    }
  }
}

}  // namespace trocar::view
