// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/marching_cubes.h"

#include <algorithm>
#include <cmath>

#include "trocar/core/assert.h"

namespace trocar::anatomy {

const std::array<std::array<std::uint8_t, 2>, 12> kCellEdges = {{{0, 1},
                                                                 {2, 3},
                                                                 {4, 5},
                                                                 {6, 7},  // along x
                                                                 {0, 2},
                                                                 {1, 3},
                                                                 {4, 6},
                                                                 {5, 7},  // along y
                                                                 {0, 4},
                                                                 {1, 5},
                                                                 {2, 6},
                                                                 {3, 7}}};  // along z

namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

constexpr double kEndDistance = 0.02;  // of an edge's length

/// Corners of each face, counter-clockwise seen from outside the cell.
constexpr std::uint8_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

int FindEdge(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    if ((kCellEdges[e][0] == a && kCellEdges[e][1] == b) || (kCellEdges[e][0] == b && kCellEdges[e][1] == a))
      return e;
  }
  return -1;
}

bool ShareFace(int e, int f) {
  for (const auto& face : kFaces) {
    const auto holds = [&](int edge) {
      return std::count(face, face + 4, kCellEdges[edge][0]) == 1 &&
             std::count(face, face + 4, kCellEdges[edge][1]) == 1;
    };
    if (holds(e) && holds(f)) return true;
  }
  return false;
}

std::vector<CellLoop> MakeLoops(unsigned inside) {
  // on each face a segment runs around every group of inside corners
  int next[12];
  std::fill(next, next + 12, -1);
  for (const auto& face : kFaces) {
    const auto is_inside = [&](int k) { return (inside >> face[k & 3] & 1u) != 0; };
    for (int k = 0; k < 4; ++k) {
      if (is_inside(k) || !is_inside(k + 1)) continue;
      // the group starts at corner k + 1; find the corner where it ends
      int last = k + 1;
      while (is_inside(last + 1)) ++last;
      next[FindEdge(face[k & 3], face[(k + 1) & 3])] = FindEdge(face[last & 3], face[(last + 1) & 3]);
    }
  }
  std::vector<CellLoop> loops;
  bool used[12] = {};
  for (int start = 0; start < 12; ++start) {
    if (next[start] < 0 || used[start]) continue;
    CellLoop loop;
    for (int e = start; !used[e]; e = next[e]) {
      used[e] = true;
      loop.edges.push_back(static_cast<std::uint8_t>(e));
    }
    // a fan whose inner sides all run through the cell's inside, else a centre
    const std::size_t n = loop.edges.size();
    loop.has_centre = true;
    for (std::size_t apex = 0; apex < n && loop.has_centre; ++apex) {
      bool is_clear = true;
      for (std::size_t k = 2; k + 1 < n; ++k)
        is_clear &= !ShareFace(loop.edges[apex], loop.edges[(apex + k) % n]);
      if (!is_clear) continue;
      std::rotate(loop.edges.begin(), loop.edges.begin() + static_cast<std::ptrdiff_t>(apex),
                  loop.edges.end());
      loop.has_centre = false;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

const std::vector<CellLoop>& FindCellLoops(unsigned inside) {
  static const auto table = [] {
    std::array<std::vector<CellLoop>, 256> loops;
    for (unsigned signs = 0; signs < 256; ++signs) loops[signs] = MakeLoops(signs);
    return loops;
  }();
  TROCAR_ASSERT(inside < 256);
  return table[inside];
}

TriangleMesh MarchCubes(const ScalarVolume& volume) {
  TriangleMesh mesh;
  const int nx = volume.size[0], ny = volume.size[1], nz = volume.size[2];
  if (volume.values.empty()) return mesh;
  const auto value_at = [&](int i, int j, int k) -> double {
    if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) return -0.5 * volume.spacing;
    return volume.values[volume.Index(i, j, k)];
  };

  // vertex on each lattice edge of two layers, by the edge's lower corner and axis; corners count from -1
  constexpr std::uint32_t kNone = 0xffffffffu;
  const std::size_t layer = static_cast<std::size_t>(nx + 2) * (ny + 2) * 3;
  std::vector<std::uint32_t> below(layer, kNone), above(layer, kNone);
  const auto slot = [&](int i, int j, int axis) {
    return ((static_cast<std::size_t>(j) + 1) * (nx + 2) + i + 1) * 3 + axis;
  };

  for (int k = -1; k < nz; ++k) {
    std::fill(above.begin(), above.end(), kNone);
    for (int j = -1; j < ny; ++j) {
      for (int i = -1; i < nx; ++i) {
        double values[8];
        unsigned inside = 0;
        for (int c = 0; c < 8; ++c) {
          values[c] = value_at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1));
          if (values[c] > 0) inside |= 1u << c;
        }
        if (inside == 0 || inside == 255) continue;
        const auto vertex_on = [&](int edge) {
          const int a = kCellEdges[edge][0], b = kCellEdges[edge][1];
          const int axis = edge / 4;
          auto& table = (a >> 2 & 1) ? above : below;
          std::uint32_t& vertex = table[slot(i + (a & 1), j + (a >> 1 & 1), axis)];
          if (vertex == kNone) {
            const double t =
                std::clamp(values[a] / (values[a] - values[b]), kEndDistance, 1.0 - kEndDistance);
            const Vec3 p = volume.Position(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2 & 1));
            const Vec3 q = volume.Position(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1));
            vertex = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(math::Lerp(p, q, t));
          }
          return vertex;
        };
        for (const CellLoop& loop : FindCellLoops(inside)) {
          const std::size_t n = loop.edges.size();
          std::uint32_t corners[12];
          for (std::size_t e = 0; e < n; ++e) corners[e] = vertex_on(loop.edges[e]);
          if (!loop.has_centre) {
            for (std::size_t e = 1; e + 1 < n; ++e)
              mesh.triangles.push_back({corners[0], corners[e], corners[e + 1]});
            continue;
          }
          Vec3 centre;
          for (std::size_t e = 0; e < n; ++e) centre += mesh.positions[corners[e]];
          const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
          mesh.positions.push_back(centre / static_cast<double>(n));
          for (std::size_t e = 0; e < n; ++e)
            mesh.triangles.push_back({middle, corners[e], corners[(e + 1) % n]});
        }
      }
    }
    std::swap(below, above);
  }
  return mesh;
}

}  // namespace trocar::anatomy
