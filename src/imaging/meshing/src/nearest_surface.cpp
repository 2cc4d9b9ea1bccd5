// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/nearest_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"

namespace trocar::meshing {

using math::Vec3;

namespace {
constexpr int kMaxCellsAnAxis = 160;
constexpr double kRounded = 1.0 + 1e-9;  // a ball that rounding cannot make too small
}  // namespace

NearestSurface::NearestSurface(const geometry::TriangleMesh& mesh) : mesh_(mesh) {
  TROCAR_ASSERT(!mesh.triangles.empty());
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const Vec3 extent = box.max - box.min;
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-12});
  const double area = geometry::CalcArea(mesh.positions, mesh.triangles);
  cell_ =
      std::max(2.0 * std::sqrt(area / static_cast<double>(mesh.triangles.size())), longest / kMaxCellsAnAxis);
  origin_ = box.min;
  for (int axis = 0; axis < 3; ++axis) size_[axis] = base::TruncateTo<int>(extent[axis] / cell_) + 1;

  balls_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 centre = (a + b + c) / 3.0;
    const double squared = std::max({math::SquaredDistance(centre, a), math::SquaredDistance(centre, b),
                                     math::SquaredDistance(centre, c)});
    balls_.push_back({centre, kRounded * std::sqrt(squared)});
  }
  const std::size_t cells = static_cast<std::size_t>(size_[0]) * size_[1] * size_[2];
  starts_.assign(cells + 1, 0);
  // two passes: count, then fill
  for (const bool fill : {false, true}) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& triangle = mesh.triangles[t];
      const Vec3 corners[3] = {mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                               mesh.positions[triangle[2]]};
      const geometry::Box bounds = geometry::CalcBox(corners);
      const auto low = CellOf(bounds.min), high = CellOf(bounds.max);
      for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
          for (int x = low[0]; x <= high[0]; ++x) {
            const std::size_t cell = (static_cast<std::size_t>(z) * size_[1] + y) * size_[0] + x;
            if (fill)
              triangles_[starts_[cell]++] = t;
            else
              ++starts_[cell + 1];
          }
        }
      }
    }
    if (!fill) {
      for (std::size_t c = 0; c < cells; ++c) starts_[c + 1] += starts_[c];
      triangles_.resize(starts_[cells]);
    }
  }
  // filling moved each start to its end
  for (std::size_t c = cells; c > 0; --c) starts_[c] = starts_[c - 1];
  starts_[0] = 0;
}

std::array<int, 3> NearestSurface::CellOf(const Vec3& p) const {
  std::array<int, 3> cell;
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = base::TruncateTo<int>(std::clamp((p[axis] - origin_[axis]) / cell_, 0.0, size_[axis] - 1.0));
  }
  return cell;
}

SurfacePoint NearestSurface::Find(const Vec3& p) const {
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::max();
  const auto centre = CellOf(p);
  // a point outside the grid is further away than its ring number says, never nearer
  const int last_ring = std::max({size_[0], size_[1], size_[2]});
  for (int ring = 0; ring <= last_ring; ++ring) {
    if (ring > 1 && best_squared <= (ring - 1) * cell_ * (ring - 1) * cell_) break;
    for (int z = centre[2] - ring; z <= centre[2] + ring; ++z) {
      if (z < 0 || z >= size_[2]) continue;
      for (int y = centre[1] - ring; y <= centre[1] + ring; ++y) {
        if (y < 0 || y >= size_[1]) continue;
        const bool is_wall = std::abs(z - centre[2]) == ring || std::abs(y - centre[1]) == ring;
        for (int x = centre[0] - ring; x <= centre[0] + ring; x += is_wall || ring == 0 ? 1 : 2 * ring) {
          if (x < 0 || x >= size_[0]) continue;
          const std::size_t cell = (static_cast<std::size_t>(z) * size_[1] + y) * size_[0] + x;
          for (std::uint32_t k = starts_[cell]; k < starts_[cell + 1]; ++k) {
            const Ball& ball = balls_[triangles_[k]];
            const double clearance = std::sqrt(math::SquaredDistance(p, ball.centre)) - ball.radius;
            if (clearance > 0 && clearance * clearance > best_squared) continue;
            const auto& t = mesh_.triangles[triangles_[k]];
            const auto at = geometry::FindNearestOnTriangle(p, mesh_.positions[t[0]], mesh_.positions[t[1]],
                                                            mesh_.positions[t[2]]);
            const double squared = math::SquaredDistance(p, at.point);
            if (squared < best_squared || (squared == best_squared && triangles_[k] < best.triangle)) {
              best_squared = squared;
              best = {triangles_[k], at, 0.0};
            }
          }
        }
      }
    }
  }
  best.distance = std::sqrt(best_squared);
  return best;
}

bool NearestSurface::IsInside(const Vec3& p) const {
  // sum of the triangles' solid angles: 4 pi inside, 0 outside (van Oosterom and Strackee 1983)
  double sum = 0.0;
  for (const auto& t : mesh_.triangles) {
    const Vec3 a = mesh_.positions[t[0]] - p, b = mesh_.positions[t[1]] - p, c = mesh_.positions[t[2]] - p;
    const double la = Norm(a), lb = Norm(b), lc = Norm(c);
    sum += 2.0 *
           math::Atan2(Dot(a, Cross(b, c)), la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb);
  }
  return sum > 2.0 * M_PI;
}

}  // namespace trocar::meshing
