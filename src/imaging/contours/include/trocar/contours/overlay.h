// SPDX-License-Identifier: Apache-2.0
/// \file overlay.h  Pictures to check contours by eye: the photograph with the stages of each contour drawn
/// on it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "trocar/images/image_stack.h"
#include "trocar/images/mask.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// The stages of one contour.
struct ContourStages {
  std::vector<math::Vec2> placed;    ///< control points, red squares
  std::vector<math::Vec2> adapted;   ///< after the edge adaption, yellow squares
  std::vector<math::Vec2> curve;     ///< closed spline, green line
  std::vector<math::Vec2> inserted;  ///< added on the edge, cyan squares
  std::string structure;             ///< whose contour it is
  std::size_t notes = 0;             ///< places where the curve does not fit, see contour_fit.h
};

/// Everything that is drawn on one slice.
struct Overlay {
  std::vector<ContourStages> contours;
  std::vector<images::Mask> areas;                 ///< tinted
  std::vector<math::Vec2> tube_points;             ///< blue crosses
  std::vector<std::vector<math::Vec2>> reference;  ///< closed outlines to compare with, magenta lines
};

/// The part of the photograph around the contours, enlarged, with the overlay.
///
/// \param scale  pictures' pixels a photograph's pixel, 1 to 8
images::ColorImage DrawOverlay(const images::ColorImage& photograph, const Overlay& overlay, int scale = 2);

}  // namespace trocar::contours
