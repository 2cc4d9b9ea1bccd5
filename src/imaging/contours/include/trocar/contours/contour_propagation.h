// SPDX-License-Identifier: Apache-2.0
/// \file contour_propagation.h  Carries a contour to a neighbouring slice.
///
/// The band of the picture along the contour is straightened in both slices. Each point moves along its
/// normal to where the bands correlate best, neighbours together (dynamic programming over the closed
/// contour), and then to the edge.
/// Source: normalised cross-correlation, Lewis, "Fast normalized cross-correlation", Vision Interface 1995;
/// Amini, Weymouth, Jain, PAMI 1990.
#pragma once

#include <span>
#include <vector>

#include "trocar/contours/edge_adaption.h"
#include "trocar/contours/edge_field.h"
#include "trocar/images/image_stack.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

struct PropagationSettings {
  double max_shift_px = 12.0;  ///< how far the organ's border may have moved [pixels], > 0
  double band_px = 12.0;       ///< half the width of the band that is matched [pixels], > 0
  double smoothness = 0.05;    ///< cost of neighbours that move differently, against correlation [-], >= 0
  bool is_adapting = true;     ///< the points move on to the edge
  EdgeAdaptionSettings adaption;
};

struct PropagatedContour {
  std::vector<math::Vec2> points;  ///< (n) in the other slice [pixels]
  std::vector<double> confidence;  ///< (n) 1: the picture looks alike there, 0: it does not [-]
};

/// \param from, to  neighbouring slices of equal size
/// \param points    (n) n >= 3 control points in `from` [pixels]
/// \pre equal sizes, n >= 3 (TROCAR_ASSERT)
PropagatedContour PropagateContour(const images::ColorImage& from, const images::ColorImage& to,
                                   std::span<const math::Vec2> points,
                                   const PropagationSettings& settings = {});
PropagatedContour PropagateContour(const EdgeField& from, const EdgeField& to,
                                   std::span<const math::Vec2> points,
                                   const PropagationSettings& settings = {});

}  // namespace trocar::contours
