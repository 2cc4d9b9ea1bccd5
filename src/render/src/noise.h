// SPDX-License-Identifier: Apache-2.0
/// \file noise.h  Smooth and cellular noise over space, the same on every machine.
/// Sources: Perlin, "Improving noise", SIGGRAPH 2002; Worley, "A cellular texture basis function", SIGGRAPH
/// 1996.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::render {

/// Gradient noise, about -1 to 1, one bump per unit.
/// \param period  repeats after that many units; 0 never
double CalcGradientNoise(const math::Vec3& p, int period) noexcept;

/// Distances to the nearest and the second nearest of one random point per unit cell.
struct CellNoise {
  double nearest = 0, second = 0;
};
CellNoise CalcCellNoise(const math::Vec3& p, int period) noexcept;

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
