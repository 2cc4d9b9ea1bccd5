// SPDX-License-Identifier: Apache-2.0
#include "volume_opening.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "trocar/contours/organ_growth.h"

namespace trocar::contours {

double CalcEdgeLength(const meshing::ScalarVolume& volume, int triangles) {
  std::size_t faces = 0;
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<std::size_t>(volume.size[static_cast<std::size_t>(axis)]);
    for (std::size_t i = 0; i + stride < volume.values.size(); ++i) {
      if (i / stride % length + 1 == length) continue;
      faces += (volume.values[i] > 0) != (volume.values[i + stride] > 0) ? 1 : 0;
    }
    stride *= length;
  }
  const double area = 2.0 / 3.0 * static_cast<double>(faces) * volume.spacing * volume.spacing;
  return std::sqrt(4.0 / std::sqrt(3.0) * area / triangles);
}

void OpenVolume(meshing::ScalarVolume& volume, double radius_mm) {
  const double step = volume.spacing;
  if (radius_mm < 2 * step) return;
  std::vector<std::uint8_t> set(volume.values.size());
  for (std::size_t i = 0; i < set.size(); ++i) set[i] = volume.values[i] > 0 ? 0 : 1;
  const std::array<double, 3> steps = {step, step, step};
  const auto depth = CalcDistances(set, volume.size, steps);
  // the border lies half a sample before the nearest one outside
  for (std::size_t i = 0; i < set.size(); ++i)
    set[i] = depth[i] >= static_cast<float>(radius_mm + 0.5 * step) ? 1 : 0;
  if (std::find(set.begin(), set.end(), 1) == set.end()) return;
  const auto around = CalcDistances(set, volume.size, steps);
  // a sample more, so that the lattice does not show where the ball does reach the border
  for (std::size_t i = 0; i < set.size(); ++i)
    volume.values[i] = std::min(volume.values[i], static_cast<float>(radius_mm + step) - around[i]);
}

}  // namespace trocar::contours
