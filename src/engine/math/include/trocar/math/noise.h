// SPDX-License-Identifier: Apache-2.0
/// \file noise.h  Smooth and cellular noise over space, the same on every machine.
/// Sources: Perlin, "Improving noise", SIGGRAPH 2002; Worley, "A cellular texture basis function", SIGGRAPH
/// 1996.
#pragma once

#include "trocar/math/vector.h"

namespace trocar::math {

/// Gradient noise, about -1 to 1, one bump per unit.
/// \param period  repeats after that many units; 0 never
double CalcGradientNoise(const Vec3& p, int period) noexcept;

/// Distances to the nearest and the second nearest of one random point per unit cell.
struct CellNoise {
  double nearest = 0, second = 0;
};
CellNoise CalcCellNoise(const Vec3& p, int period) noexcept;

}  // namespace trocar::math
