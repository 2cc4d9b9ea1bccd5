// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/primitives.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "trocar/base/assert.h"

namespace trocar::geometry {

using math::Vec3;

TriangleMesh MakeSphere(const Vec3& centre, double radius, int subdivisions) {
  TROCAR_ASSERT(radius > 0.0 && subdivisions >= 0 && subdivisions <= 8);
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh{{{-1, g, 0},
                     {1, g, 0},
                     {-1, -g, 0},
                     {1, -g, 0},
                     {0, -1, g},
                     {0, 1, g},
                     {0, -1, -g},
                     {0, 1, -g},
                     {g, 0, -1},
                     {g, 0, 1},
                     {-g, 0, -1},
                     {-g, 0, 1}},
                    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (is_new) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    finer.reserve(4 * mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3& p : mesh.positions) p = math::Normalized(p);
  }
  for (Vec3& p : mesh.positions) p = centre + radius * math::Normalized(p);
  return mesh;
}

TriangleMesh MakeGrid(int n, double spacing) {
  TROCAR_ASSERT(n >= 2 && spacing > 0.0);
  TriangleMesh mesh;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) mesh.positions.push_back({column * spacing, row * spacing, 0});
  }
  const auto index = [n](int column, int row) { return static_cast<std::uint32_t>(row * n + column); };
  for (int row = 0; row + 1 < n; ++row) {
    for (int column = 0; column + 1 < n; ++column) {
      mesh.triangles.push_back({index(column, row), index(column + 1, row), index(column + 1, row + 1)});
      mesh.triangles.push_back({index(column, row), index(column + 1, row + 1), index(column, row + 1)});
    }
  }
  return mesh;
}

TriangleMesh MakeTriangularLattice(int columns, int rows, double spacing) {
  TROCAR_ASSERT(columns >= 2 && rows >= 2 && spacing > 0.0);
  TriangleMesh mesh;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      mesh.positions.push_back({(column + 0.5 * (row % 2)) * spacing, row * spacing * std::sqrt(0.75), 0});
    }
  }
  const auto index = [columns](int column, int row) {
    return static_cast<std::uint32_t>(row * columns + column);
  };
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const auto a = index(column, row), b = index(column + 1, row), c = index(column, row + 1),
                 d = index(column + 1, row + 1);
      if (row % 2 == 0)
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
      else
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
    }
  }
  return mesh;
}

TriangleMesh MakeBox(const Vec3& min, const Vec3& max) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back(
        {corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace trocar::geometry
