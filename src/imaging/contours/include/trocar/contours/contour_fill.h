// SPDX-License-Identifier: Apache-2.0
/// \file contour_fill.h  Flood fill of the area that contours enclose.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, last step.
#pragma once

#include <span>
#include <vector>

#include "trocar/images/mask.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// Marks the pixels whose centres lie inside a closed polyline.
///
/// Fills from a corner of the mask, which is outside. The walls are the places where the polyline passes
/// between two neighbouring pixel centres; a step through a wall changes sides, so that a pocket narrower
/// than a pixel is found too. Equal to the even-odd rule at every pixel centre.
/// \param contour  (n) n >= 3 closed polyline [pixels]
/// \param[in,out] mask  pixels inside become 1, the others keep their value; the
/// contour must lie inside the rectangle
/// \pre a border of one pixel of the mask is outside the contour (TROCAR_ASSERT)
void FillContour(std::span<const math::Vec2> contour, images::Mask& mask);

/// Union of the contours without the holes.
images::Mask FillArea(const std::vector<std::vector<math::Vec2>>& contours,
                      const std::vector<std::vector<math::Vec2>>& holes);

}  // namespace trocar::contours
