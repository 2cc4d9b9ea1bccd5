// SPDX-License-Identifier: Apache-2.0
// The tables of marching cubes, generated from the cell's faces.
#include <algorithm>

#include "trocar/base/assert.h"
#include "trocar/meshing/marching_cubes.h"

namespace trocar::meshing {

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
const std::array<std::array<std::uint8_t, 4>, 6> kCellFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

namespace {

int FindEdge(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    if ((kCellEdges[e][0] == a && kCellEdges[e][1] == b) || (kCellEdges[e][0] == b && kCellEdges[e][1] == a))
      return e;
  }
  return -1;
}

bool ShareFace(int e, int f) {
  for (const auto& face : kCellFaces) {
    const auto holds = [&](int edge) {
      return std::count(face.begin(), face.end(), kCellEdges[edge][0]) == 1 &&
             std::count(face.begin(), face.end(), kCellEdges[edge][1]) == 1;
    };
    if (holds(e) && holds(f)) return true;
  }
  return false;
}

/// Where the surface goes on from each cut edge, along the faces; -1 for edges that are not cut.
std::array<int, 12> FindNextEdges(unsigned inside, unsigned joined) {
  std::array<int, 12> next;
  next.fill(-1);
  for (unsigned f = 0; f < 6; ++f) {
    const auto& face = kCellFaces[f];
    const auto is_inside = [&](int k) { return (inside >> face[k & 3] & 1u) != 0; };
    const auto edge_after = [&](int k) { return FindEdge(face[k & 3], face[(k + 1) & 3]); };
    for (int k = 0; k < 4; ++k) {
      if (is_inside(k) || !is_inside(k + 1)) continue;
      // the way enters a group of inside corners at k + 1
      int last = k + 1;
      if (joined >> f & 1u) {
        last = k - 1;  // the group before: the segment cuts off the outside corner k
      } else {
        while (is_inside(last + 1)) ++last;  // around this group
      }
      next[static_cast<std::size_t>(edge_after(k))] = edge_after(last + 4);
    }
  }
  return next;
}

/// Turns the loop so that a fan from its first edge has every inner side in the cell's inside, or asks for a
/// centre.
void ChooseFan(CellLoop& loop) {
  const std::size_t n = loop.edges.size();
  for (std::size_t apex = 0; apex < n; ++apex) {
    bool is_clear = true;
    for (std::size_t k = 2; k + 1 < n; ++k)
      is_clear &= !ShareFace(loop.edges[apex], loop.edges[(apex + k) % n]);
    if (!is_clear) continue;
    std::rotate(loop.edges.begin(), loop.edges.begin() + static_cast<std::ptrdiff_t>(apex), loop.edges.end());
    return;
  }
  loop.has_centre = true;
}

std::vector<CellLoop> MakeLoops(unsigned inside, unsigned joined) {
  const auto next = FindNextEdges(inside, joined);
  std::vector<CellLoop> loops;
  bool used[12] = {};
  for (int start = 0; start < 12; ++start) {
    if (next[static_cast<std::size_t>(start)] < 0 || used[start]) continue;
    CellLoop loop;
    for (int e = start; !used[e]; e = next[static_cast<std::size_t>(e)]) {
      used[e] = true;
      loop.edges.push_back(static_cast<std::uint8_t>(e));
    }
    ChooseFan(loop);
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

unsigned FindAmbiguousFaces(unsigned inside) {
  static const auto table = [] {
    std::array<std::uint8_t, 256> ambiguous{};
    for (unsigned signs = 0; signs < 256; ++signs) {
      for (unsigned f = 0; f < 6; ++f) {
        const auto at = [&](int k) { return signs >> kCellFaces[f][static_cast<std::size_t>(k)] & 1u; };
        if (at(0) == at(2) && at(1) == at(3) && at(0) != at(1))
          ambiguous[signs] = static_cast<std::uint8_t>(ambiguous[signs] | 1u << f);
      }
    }
    return ambiguous;
  }();
  return table[inside];
}

const std::vector<CellLoop>& FindCellLoops(unsigned inside, unsigned joined) {
  static const auto table = [] {
    std::vector<std::vector<CellLoop>> loops(256u * 64u);
    for (unsigned signs = 0; signs < 256; ++signs) {
      const unsigned ambiguous = FindAmbiguousFaces(signs);
      for (unsigned faces = 0; faces < 64; ++faces) {
        if ((faces & ~ambiguous) == 0) loops[signs * 64 + faces] = MakeLoops(signs, faces);
      }
    }
    return loops;
  }();
  TROCAR_ASSERT(inside < 256 && (joined & ~FindAmbiguousFaces(inside)) == 0);
  return table[inside * 64 + joined];
}

}  // namespace trocar::meshing
