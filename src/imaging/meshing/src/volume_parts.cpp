// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "connected_parts.h"
#include "trocar/meshing/volume.h"

namespace trocar::meshing {

void KeepLargestPart(ScalarVolume& volume) {
  const auto other_side = static_cast<float>(0.5 * volume.spacing);
  const auto width = static_cast<std::size_t>(volume.size[0]);
  for (const bool inside : {true, false}) {
    const auto is_on_side = [&](std::size_t row, int i) {
      return (volume.values[row * width + static_cast<std::size_t>(i)] > 0) == inside;
    };
    for (const Run& run : ConnectedParts(volume.size, is_on_side).FindLesser()) {
      float* values = &volume.values[run.row * width];
      std::fill(values + run.begin, values + run.end, inside ? -other_side : other_side);
    }
  }
}

}  // namespace trocar::meshing
