// SPDX-License-Identifier: Apache-2.0
/// \file mask.h  Which pixels of a picture belong to something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace trocar::images {

/// Rectangle of pixels with a flag each. Pixel (x, y) has its centre at (x0 + x, y0 + y) of the picture.
struct Mask {
  int x0 = 0, y0 = 0;
  int width = 0, height = 0;
  std::vector<std::uint8_t> inside;  ///< (height * width) 0 or 1

  std::uint8_t At(int x, int y) const { return inside[static_cast<std::size_t>(y) * width + x]; }
  /// How many pixels are set.
  std::size_t Count() const { return std::accumulate(inside.begin(), inside.end(), std::size_t{0}); }
};

}  // namespace trocar::images
