// SPDX-License-Identifier: Apache-2.0
#include "pool_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "trocar/base/assert.h"

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
constexpr double kDry = -kFilm - kSpacing;             // m; there is none
constexpr double kBankSlope = 0.6;                     // of the steepest bank
constexpr double kClear = 0.0008;                      // m of liquid that hide 63 % of what is under it
constexpr double kBulge = 0.0010;    // m that lobules under one membrane stand out of themselves
constexpr double kFatShore = 0.006;  // m from a lobule, farther than its shore reaches
constexpr double kShoreSlope = 0.6;  // of an end where there is no ground

constexpr double kUnknown = -std::numeric_limits<double>::infinity();

/// std::hypot without its care for lengths that no lattice has, which takes most of its time.
double CalcLength(double x, double y) {
  return std::sqrt(x * x + y * y);
}

}  // namespace

double CalcPoolShare(double depth) noexcept {
  return depth > -kFilm ? 1.0 - std::exp(-(depth + kFilm) / kClear) : 0.0;
}

void PoolSurface::Make(const render::Puddle& puddle, const Vec3& lowest, std::span<const GroundShape> ground,
                       std::span<const FatLobule> lobules) {
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
  clearances_.assign(heights_.size(), -kUnknown);
  for (const GroundShape& shape : ground) MeetGround(shape);
  for (const FatLobule& lobule : lobules) MeetLobule(lobule);
  FindThickness(puddle, deepest);
  AddBanks();
  AddVertices();
  AddTriangles();
}

/// The highest ground at each point that does not hang over the level.
void PoolSurface::MeetGround(const GroundShape& shape) {
  lattice_.resize(shape.positions.size());
  for (std::size_t v = 0; v < lattice_.size(); ++v) {
    const Vec3 from = shape.positions[v] - corner_;
    lattice_[v] = {math::Dot(from, right_) / kSpacing, math::Dot(from, ahead_) / kSpacing,
                   math::Dot(from, up_)};
  }
  const double last = side_ - 1;
  for (const auto& [ia, ib, ic] : shape.triangles) {
    TROCAR_ASSERT(std::max({ia, ib, ic}) < shape.positions.size());
    const std::array<double, 3> x = {lattice_[ia].x, lattice_[ib].x, lattice_[ic].x};
    const auto [least_x, most_x] = std::minmax({x[0], x[1], x[2]});
    if (most_x < 0.0 || least_x > last) continue;  // nearly all of them
    const std::array<double, 3> y = {lattice_[ia].y, lattice_[ib].y, lattice_[ic].y};
    const auto [least_y, most_y] = std::minmax({y[0], y[1], y[2]});
    if (most_y < 0.0 || least_y > last) continue;
    const int from_x = std::max(0, static_cast<int>(std::ceil(least_x)));
    const int to_x = std::min(side_ - 1, static_cast<int>(std::floor(most_x)));
    const int from_y = std::max(0, static_cast<int>(std::ceil(least_y)));
    const int to_y = std::min(side_ - 1, static_cast<int>(std::floor(most_y)));
    if (from_x > to_x || from_y > to_y) continue;
    const std::array<double, 3> z = {lattice_[ia].z, lattice_[ib].z, lattice_[ic].z};
    const Vec3& a = shape.positions[ia];
    const Vec3 normal = math::Cross(shape.positions[ib] - a, shape.positions[ic] - a);
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

/// A lobule is too steep to be ground: what counts is how far a point lies from where it passes through the level.
void PoolSurface::MeetLobule(const FatLobule& lobule) {
  const Vec3 from = lobule.centre - corner_;
  const double above = math::Dot(from, up_), squared = lobule.radius * lobule.radius - above * above;
  if (!(squared > 0.0)) return;
  const double radius = std::sqrt(squared), x = math::Dot(from, right_), y = math::Dot(from, ahead_);
  const double reach = radius + kFatShore;
  const auto range = [&](double middle) {
    return std::pair{std::max(0, static_cast<int>(std::ceil((middle - reach) / kSpacing))),
                     std::min(side_ - 1, static_cast<int>(std::floor((middle + reach) / kSpacing)))};
  };
  const auto [from_x, to_x] = range(x);
  const auto [from_y, to_y] = range(y);
  for (int row = from_y; row <= to_y; ++row) {
    for (int column = from_x; column <= to_x; ++column) {
      double& clearance = clearances_[At(column, row)];
      clearance = std::min(clearance, CalcLength(column * kSpacing - x, row * kSpacing - y) - radius);
    }
  }
}

void PoolSurface::FindThickness(const render::Puddle& puddle, double deepest) {
  thickness_.resize(heights_.size());
  const double half = 0.5 * (side_ - 1);
  for (int row = 0; row < side_; ++row) {
    for (int column = 0; column < side_; ++column) {
      const std::size_t at = At(column, row);
      const double side = kSpacing * CalcLength(column - half, row - half) / puddle.radius;
      // what stands above the level with nothing under it is ground, too: an island
      double height = heights_[at];
      if (height == kUnknown && overhangs_[at] < kTallest) height = overhangs_[at];
      double depth = height == kUnknown ? deepest * (1.0 - side * side) : -height;
      depth = std::min(depth, kShoreSlope * puddle.radius * (1.0 - side) + kFilm);
      // at fat it thins out to nothing, so that no edge is seen there
      thickness_[at] = std::max(std::min(depth, clearances_[at] - kFilm - kBulge), kDry);
    }
  }
}

/// Nowhere does it end as a wall, whatever the ground does between two points: its thickness follows a bank. Two sweeps carry
/// that from point to point (Borgefors 1986).
void PoolSurface::AddBanks() {
  const auto follow = [this](int column, int row, int to_column, int to_row, double steps) {
    if (to_column < 0 || to_row < 0 || to_column >= side_ || to_row >= side_) return;
    double& here = thickness_[At(column, row)];
    here = std::min(here, thickness_[At(to_column, to_row)] + steps * kBankSlope * kSpacing);
  };
  for (const int way : {-1, 1}) {
    for (int i = 0; i < side_; ++i) {
      const int row = way < 0 ? i : side_ - 1 - i;
      for (int j = 0; j < side_; ++j) {
        const int column = way < 0 ? j : side_ - 1 - j;
        follow(column, row, column + way, row, 1.0);
        follow(column, row, column, row + way, 1.0);
        follow(column, row, column - 1, row + way, M_SQRT2);
        follow(column, row, column + 1, row + way, M_SQRT2);
      }
    }
  }
}

void PoolSurface::AddVertices() {
  vertex_.assign(heights_.size(), -1);
  const double half = 0.5 * (side_ - 1);
  for (int row = 0; row < side_; ++row) {
    for (int column = 0; column < side_; ++column) {
      // a lattice point beyond the shore closes the mesh there
      const double depth = thickness_[At(column, row)];
      if (depth <= kDry) continue;
      const double climb = kClimb * std::exp(depth > 0.0 ? -depth / kInside : depth / kOutside);
      vertex_[At(column, row)] = static_cast<std::int32_t>(mesh_.positions.size());
      mesh_.positions.push_back(corner_ + (column * kSpacing) * right_ + (row * kSpacing) * ahead_ +
                                (climb + std::max(0.0, -depth)) * up_);
      rest_.push_back({(column - half) * kSpacing, (row - half) * kSpacing, 0});
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
