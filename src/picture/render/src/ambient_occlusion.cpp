// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/ambient_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::render {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

constexpr int kDirections = 32;
constexpr int kCellsPerReach = 10;
constexpr double kLargestGrid = 16e6;  // cells; a farther-flung scene gets coarser cells

/// Which cubes of space hold a piece of surface.
class SurfaceGrid {
 public:
  SurfaceGrid(std::span<const TriangleMesh* const> meshes, double cell) : cell_(cell) {
    geometry::Box box{{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
    for (const TriangleMesh* mesh : meshes) {
      if (mesh->positions.empty()) continue;
      const geometry::Box own = geometry::CalcBox(mesh->positions);
      box = {math::Min(box.min, own.min), math::Max(box.max, own.max)};
    }
    if (box.min.x > box.max.x) return;
    min_ = box.min;
    const Vec3 size = box.max - box.min;
    const double cells = (size.x / cell + 1) * (size.y / cell + 1) * (size.z / cell + 1);
    if (cells > kLargestGrid) cell_ *= std::cbrt(cells / kLargestGrid);
    for (int i = 0; i < 3; ++i) count_[static_cast<std::size_t>(i)] = static_cast<int>(size[i] / cell_) + 1;
    filled_.resize(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                   static_cast<std::size_t>(count_[2]));
    for (const TriangleMesh* mesh : meshes) {
      for (const auto& [a, b, c] : mesh->triangles)
        Fill(mesh->positions[a], mesh->positions[b], mesh->positions[c]);
    }
  }

  bool IsFilled(const Vec3& p) const {
    const std::ptrdiff_t i = FindCell(p);
    return i >= 0 && filled_[static_cast<std::size_t>(i)] != 0;
  }

 private:
  std::ptrdiff_t FindCell(const Vec3& p) const {
    const Vec3 q = (p - min_) / cell_;
    if (!(q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x < count_[0] && q.y < count_[1] && q.z < count_[2]))
      return -1;
    return (static_cast<std::ptrdiff_t>(q.z) * count_[1] + static_cast<std::ptrdiff_t>(q.y)) * count_[0] +
           static_cast<std::ptrdiff_t>(q.x);
  }

  void Fill(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({math::Distance(a, b), math::Distance(b, c), math::Distance(c, a)});
    const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * longest / cell_)));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const std::ptrdiff_t cell =
            FindCell(a + (double(i) / steps) * (b - a) + (double(j) / steps) * (c - a));
        if (cell >= 0) filled_[static_cast<std::size_t>(cell)] = 1;
      }
    }
  }

  double cell_;
  Vec3 min_;
  std::array<int, 3> count_{};
  std::vector<std::uint8_t> filled_;
};

/// Directions over the half-space z > 0, denser at the top as the cosine wants it (Fibonacci spiral).
std::array<Vec3, kDirections> MakeDirections() {
  std::array<Vec3, kDirections> directions;
  for (int i = 0; i < kDirections; ++i) {
    const double radius = std::sqrt((i + 0.5) / kDirections), angle = 2.399963229728653 * i;
    directions[static_cast<std::size_t>(i)] = {radius * std::cos(angle), radius * std::sin(angle),
                                               std::sqrt(1.0 - radius * radius)};
  }
  return directions;
}

}  // namespace

std::vector<double> CalcAmbientOcclusion(std::span<const TriangleMesh* const> occluders,
                                         std::span<const Vec3> positions, std::span<const Vec3> normals,
                                         double reach) {
  TROCAR_ASSERT(positions.size() == normals.size() && reach > 0.0);
  const double cell = reach / kCellsPerReach;
  const SurfaceGrid grid(occluders, cell);
  const auto directions = MakeDirections();
  std::vector<double> ambient_occlusion(positions.size(), 1.0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 n = normals[i], s = math::AnyPerpendicular(n), t = math::Cross(n, s);
    // above the cells that the surface itself fills
    const Vec3 start = positions[i] + 2.0 * cell * n;
    double covered = 0;
    for (const Vec3& local : directions) {
      const Vec3 direction = local.x * s + local.y * t + local.z * n;
      for (int step = 0; step < kCellsPerReach; ++step) {
        if (!grid.IsFilled(start + (step * cell) * direction)) continue;
        covered += 1.0 - double(step) / kCellsPerReach;
        break;
      }
    }
    ambient_occlusion[i] = 1.0 - covered / kDirections;
  }
  return ambient_occlusion;
}

}  // namespace trocar::render
