// SPDX-License-Identifier: Apache-2.0
#include "noise.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/noise.h"

namespace trocar::render {
namespace {

int Wrap(int i, int side) noexcept {
  return ((i % side) + side) % side;
}

std::uint8_t ToByte(double value) noexcept {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

}  // namespace

NoiseTiles MakeNoiseTiles(int side) {
  NoiseTiles tiles{side, {}, {}};
  const auto count =
      static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  tiles.pattern.resize(4 * count);
  tiles.bumps.resize(4 * count);
  std::vector<double> height(count);
  const auto index = [side](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(side) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(side) +
           static_cast<std::size_t>(x);
  };
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const math::Vec3 p = math::Vec3{double(x), double(y), double(z)} / side;
        const double slow = math::CalcGradientNoise(4.0 * p, 4),
                     middle = math::CalcGradientNoise(8.0 * p + math::Vec3{0.5, 0.5, 0.5}, 8);
        const double fine = math::CalcGradientNoise(16.0 * p, 16);
        const math::CellNoise cell = math::CalcCellNoise(8.0 * p, 8);
        // vessels run where a bent noise crosses zero
        const math::Vec3 bent = 3.0 * p + 0.25 * math::Vec3{slow, middle, -slow};
        const double ridge =
            1.0 - std::fabs(math::CalcGradientNoise(bent + math::Vec3{0.3, 0.7, 0.1}, 3)) * 3.0;
        const std::size_t i = index(x, y, z);
        tiles.pattern[4 * i] = ToByte(0.5 + 0.45 * slow + 0.30 * middle + 0.18 * fine);
        tiles.pattern[4 * i + 1] = ToByte(cell.nearest);
        tiles.pattern[4 * i + 2] = ToByte(ridge);
        tiles.pattern[4 * i + 3] = ToByte(1.5 * (cell.second - cell.nearest));
        height[i] = 0.5 * middle + 0.22 * fine + 0.5 * (0.7 - cell.nearest * cell.nearest);
      }
    }
  }
  // slopes by central differences, in heights per tile
  const auto wrapped = [&](int x, int y, int z) {
    return height[index(Wrap(x, side), Wrap(y, side), Wrap(z, side))];
  };
  constexpr double kSteepest = 12.0;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const std::size_t i = index(x, y, z);
        const double scale = 0.5 * side / kSteepest;
        const double slopes[3] = {scale * (wrapped(x + 1, y, z) - wrapped(x - 1, y, z)),
                                  scale * (wrapped(x, y + 1, z) - wrapped(x, y - 1, z)),
                                  scale * (wrapped(x, y, z + 1) - wrapped(x, y, z - 1))};
        for (std::size_t k = 0; k < 3; ++k) tiles.bumps[4 * i + k] = ToByte(0.5 + 0.5 * slopes[k]);
        tiles.bumps[4 * i + 3] = ToByte(0.5 + 0.5 * height[i]);
      }
    }
  }
  return tiles;
}

}  // namespace trocar::render
