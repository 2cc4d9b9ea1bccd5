// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/farthest_pair.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/collision/brute_force.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::collision {

using math::Vec3;

namespace {

using geometry::Box;

constexpr std::size_t kBruteForceLimit = 48;  // points; below, building cells costs more than it saves
constexpr std::uint32_t kCellSize = 8;        // points of the smallest cells
constexpr int kSweeps = 4;                    // walks to the farthest point, for a good first bound

struct Member {
  Vec3 point;
  std::uint32_t index;
};

struct Cell {
  Box box;
  std::uint32_t begin = 0, end = 0;
  std::uint32_t lowest = 0;  // index
  std::uint32_t child = 0;   // and child + 1; 0: none
};

/// Farther first, then lower indices.
void Consider(const Member& a, const Member& b, FarthestPair& best) {
  const double d2 = math::SquaredDistance(a.point, b.point);
  if (d2 < best.squared_distance) return;
  const auto [first, second] = std::minmax(a.index, b.index);
  if (d2 > best.squared_distance || std::pair(first, second) < std::pair(best.first, best.second)) {
    best = {first, second, d2};
  }
}

std::vector<Cell> BuildCells(std::vector<Member>& members) {
  std::vector<Cell> cells;
  cells.reserve(members.size() / 2);
  cells.push_back({{}, 0, static_cast<std::uint32_t>(members.size()), 0, 0});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Cell cell = cells[i];
    cell.box = {members[cell.begin].point, members[cell.begin].point};
    cell.lowest = members[cell.begin].index;
    for (std::uint32_t m = cell.begin; m < cell.end; ++m) {
      cell.box.min = math::Min(cell.box.min, members[m].point);
      cell.box.max = math::Max(cell.box.max, members[m].point);
      cell.lowest = std::min(cell.lowest, members[m].index);
    }
    if (cell.end - cell.begin > kCellSize) {
      const Vec3 size = cell.box.max - cell.box.min;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const std::uint32_t middle = cell.begin + (cell.end - cell.begin) / 2;
      std::nth_element(members.begin() + cell.begin, members.begin() + middle, members.begin() + cell.end,
                       [axis](const Member& a, const Member& b) {
                         return std::pair(a.point[axis], a.index) < std::pair(b.point[axis], b.index);
                       });
      cell.child = static_cast<std::uint32_t>(cells.size());
      cells.push_back({{}, cell.begin, middle, 0, 0});
      cells.push_back({{}, middle, cell.end, 0, 0});
    }
    cells[i] = cell;
  }
  return cells;
}

/// No pair of points of a and b is farther apart than this [m^2].
double CalcUpperBound(const Box& a, const Box& b) {
  const Vec3 reach = math::Max(a.max - b.min, b.max - a.min);
  return math::SquaredNorm(reach);
}

bool MayImprove(const Cell& a, const Cell& b, double bound, const FarthestPair& best) {
  if (bound != best.squared_distance) return bound > best.squared_distance;
  return std::pair(std::min(a.lowest, b.lowest), std::max(a.lowest, b.lowest)) <
         std::pair(best.first, best.second);
}

}  // namespace

FarthestPair FindFarthestPair(std::span<const Vec3> points, std::span<const std::uint32_t> indices) {
  TROCAR_ASSERT(indices.size() >= 2);
  if (indices.size() <= kBruteForceLimit) return FindFarthestPairBruteForce(points, indices);

  std::vector<Member> members;
  members.reserve(indices.size());
  for (const std::uint32_t index : indices) members.push_back({points[index], index});

  // walk from a point to its farthest point a few times
  FarthestPair best{members[0].index, members[1].index,
                    math::SquaredDistance(members[0].point, members[1].point)};
  Member from = members[0];
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    Member farthest = from;
    double farthest2 = -1.0;
    for (const Member& member : members) {
      const double d2 = math::SquaredDistance(from.point, member.point);
      if (d2 > farthest2) farthest = member, farthest2 = d2;
    }
    if (farthest.index == from.index) break;
    Consider(from, farthest, best);
    from = farthest;
  }

  // compare cells with cells, the most promising pair first
  const std::vector<Cell> cells = BuildCells(members);
  struct CellPair {
    std::uint32_t a, b;
    double bound;
  };
  std::vector<CellPair> stack{{0, 0, CalcUpperBound(cells[0].box, cells[0].box)}};
  while (!stack.empty()) {
    const CellPair pair = stack.back();
    stack.pop_back();
    const Cell &a = cells[pair.a], &b = cells[pair.b];
    if (!MayImprove(a, b, pair.bound, best)) continue;
    if (a.child == 0 && b.child == 0) {
      for (std::uint32_t i = a.begin; i < a.end; ++i) {
        for (std::uint32_t j = pair.a == pair.b ? i + 1 : b.begin; j < b.end; ++j)
          Consider(members[i], members[j], best);
      }
      continue;
    }
    std::array<CellPair, 3> next{};
    int count = 0;
    const auto add = [&](std::uint32_t i, std::uint32_t j) {
      next[count++] = {i, j, CalcUpperBound(cells[i].box, cells[j].box)};
    };
    if (pair.a == pair.b) {
      add(a.child, a.child), add(a.child, a.child + 1), add(a.child + 1, a.child + 1);
    } else if (b.child == 0 || (a.child != 0 && a.end - a.begin >= b.end - b.begin)) {
      add(a.child, pair.b), add(a.child + 1, pair.b);
    } else {
      add(pair.a, b.child), add(pair.a, b.child + 1);
    }
    // the greatest bound goes on top of the stack
    const auto greatest =
        std::max_element(next.begin(), next.begin() + count,
                         [](const CellPair& x, const CellPair& y) { return x.bound < y.bound; });
    std::swap(*greatest, next[count - 1]);
    for (int i = 0; i < count; ++i) stack.push_back(next[i]);
  }
  return best;
}

}  // namespace trocar::collision
