// SPDX-License-Identifier: Apache-2.0
/// \file contour_fill.h  Flood fill of the area that contours enclose.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, last step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::anatomy {

using math::Vec2;

/// Rectangle of pixels with a flag each. Pixel (x, y) has its centre at (x0 + x, y0 + y) of the picture.
struct Mask {
  int x0 = 0, y0 = 0;
  int width = 0, height = 0;
  std::vector<std::uint8_t> inside;  ///< (height * width) 0 or 1

  std::uint8_t At(int x, int y) const { return inside[static_cast<std::size_t>(y) * width + x]; }
  std::size_t Count() const;
};

/// Marks the pixels whose centres lie inside a closed polyline.
///
/// Fills from a corner of the mask, which is outside. The walls are the places where the polyline passes
/// between two neighbouring pixel centres; a step through a wall changes sides, so that a pocket narrower
/// than a pixel is found too. Equal to the even-odd rule at every pixel centre.
/// \param contour  (n) n >= 3 closed polyline [pixels]
/// \param[in,out] mask  pixels inside become 1, the others keep their value; the
/// contour must lie inside the rectangle
/// \pre a border of one pixel of the mask is outside the contour (TROCAR_ASSERT)
void FillContour(std::span<const Vec2> contour, Mask& mask);

/// Union of the contours without the holes.
Mask FillArea(const std::vector<std::vector<Vec2>>& contours, const std::vector<std::vector<Vec2>>& holes);

}  // namespace trocar::anatomy
