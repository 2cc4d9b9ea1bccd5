// SPDX-License-Identifier: Apache-2.0
/// \file noise.h  Tiles of noise (math/noise.h) that the shaders look up.
#pragma once

#include <cstdint>
#include <vector>

namespace trocar::render {

/// Tiles for the shaders: `side`^3 texels of four bytes, x fastest, repeating in every direction.
struct NoiseTiles {
  int side = 0;
  /// red: cloud, green: distance to a lobule's middle, blue: ridges (vessels), alpha: distance to a lobule's
  /// border
  std::vector<std::uint8_t> pattern;
  /// red, green, blue: slope of a bumpy height field along x, y, z (128 is flat), alpha: the height
  std::vector<std::uint8_t> bumps;
};
NoiseTiles MakeNoiseTiles(int side);

}  // namespace trocar::render
