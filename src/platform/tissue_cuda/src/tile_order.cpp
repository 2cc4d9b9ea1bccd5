// SPDX-License-Identifier: Apache-2.0
#include "tile_order.h"

#include <algorithm>
#include <numeric>

#include "trocar/base/assert.h"

namespace trocar::tissue_cuda {
namespace {

using math::Vec3;

int FindLongestAxis(std::span<const Vec3> positions, std::span<const std::uint32_t> part) {
  Vec3 low = positions[part.front()], high = low;
  for (const std::uint32_t i : part) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], positions[i][axis]);
      high[axis] = std::max(high[axis], positions[i][axis]);
    }
  }
  const Vec3 side = high - low;
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (side[axis] > side[longest]) longest = axis;
  }
  return longest;
}

void Bisect(std::span<const Vec3> positions, std::span<std::uint32_t> part, std::uint32_t tile_size) {
  if (part.size() <= tile_size) return;
  const std::size_t tiles = (part.size() + tile_size - 1) / tile_size;
  const std::size_t split = tiles / 2 * tile_size;
  const int axis = FindLongestAxis(positions, part);
  std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(split), part.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at_a = positions[a][axis], at_b = positions[b][axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  Bisect(positions, part.first(split), tile_size);
  Bisect(positions, part.subspan(split), tile_size);
}

}  // namespace

std::vector<std::uint32_t> CalcTileOrder(std::span<const Vec3> positions, std::uint32_t tile_size) {
  TROCAR_ASSERT(tile_size >= 1);
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  Bisect(positions, order, tile_size);
  // which points share a tile is decided; within it the order is made plain
  for (std::size_t first = 0; first < order.size(); first += tile_size) {
    const std::size_t last = std::min(order.size(), first + tile_size);
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(first),
              order.begin() + static_cast<std::ptrdiff_t>(last));
  }
  return order;
}

}  // namespace trocar::tissue_cuda
