// SPDX-License-Identifier: Apache-2.0
/// \file tile_order.h  Which nodes lie together in a tile.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::tissue_cuda {

/// Numbers points so that each run of `tile_size` lies together in space: halves the set across its longest
/// side, at a whole number of tiles, until a tile is left. Equal coordinates are decided by index, so the
/// order depends on nothing else.
///
/// \param positions  (n) finite [any unit]
/// \param tile_size  >= 1
/// \return (n) the point that stands at each place; every tile but the last is full
/// Source: Berger, Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", IEEE Trans.
/// Computers C-36(5), 1987 (recursive coordinate bisection).
std::vector<std::uint32_t> CalcTileOrder(std::span<const math::Vec3> positions, std::uint32_t tile_size);

}  // namespace trocar::tissue_cuda
