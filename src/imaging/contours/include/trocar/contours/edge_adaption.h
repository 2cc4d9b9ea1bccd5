// SPDX-License-Identifier: Apache-2.0
/// \file edge_adaption.h  Moves control points along the contour's normal to the nearest strong edge of the
/// picture.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, second step;
/// the closed contour is solved by dynamic programming as in Amini, Weymouth, Jain, "Using dynamic
/// programming for solving variational problems in vision", PAMI 1990.
#pragma once

#include <span>
#include <vector>

#include "trocar/contours/edge_field.h"
#include "trocar/images/image_stack.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// How far and how willingly points move.
struct EdgeAdaptionSettings {
  double max_shift_px = 4.0;  ///< no point moves further [pixels], 0 switches the adaption off
  double blur_px = 0.6;       ///< standard deviation of the Gaussian before the gradient [pixels], > 0
  double min_gradient =
      2.0;  ///< colour change along the normal below which there is no edge [grey levels / pixel]
  double nearness = 0.8;  ///< part of an edge's strength that is lost at max_shift_px [-], 0 to 1
  double smoothness =
      0.1;  ///< cost of neighbours that move differently by one pixel, against the strongest edge [-]
  /// In skipped slices no point leaves the interpolated contour further [pixels], 0 to 30; 0: their pictures
  /// are not looked at.
  double skipped_shift_px = 3.0;
  bool inserts_points = true;  ///< the contour chain divides splines by points on the edge, see contour_fit.h

  friend bool operator==(const EdgeAdaptionSettings&, const EdgeAdaptionSettings&) = default;
};

/// Points on their edges.
///
/// \param contour  (n) n >= 3 closed polygon [pixels], inside the image
/// \return (n) points [pixels]; a point without a clear edge within reach has not moved, and a contour that
/// would cross
///         itself moves by half, a quarter ... or not at all
/// \pre n >= 3 (TROCAR_ASSERT)
std::vector<math::Vec2> AdaptToEdges(const images::ColorImage& image, std::span<const math::Vec2> contour,
                                     const EdgeAdaptionSettings& settings);

/// As above, on a prepared edge field, whose own blur takes the place of settings.blur_px.
std::vector<math::Vec2> AdaptToEdges(const EdgeField& field, std::span<const math::Vec2> contour,
                                     const EdgeAdaptionSettings& settings);

}  // namespace trocar::contours
