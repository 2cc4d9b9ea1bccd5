// SPDX-License-Identifier: Apache-2.0
/// \file skipped_slices.h  Contours of slices that nobody contoured, from their own pictures.
///
/// Shape interpolation cuts the corner between two contoured slices and knows nothing of where an organ ends
/// beyond the last one. Here its contour is only where the search begins: in each skipped slice the edge is
/// looked for along the contour's normals, and what is found must agree from row to row and from slice to
/// slice.
/// Source: the closed path of edge_path.h; robust smoothing by reweighted least squares, Geman and McClure,
/// "Statistical methods for tomographic image reconstruction", 1987.
#pragma once

#include <span>
#include <vector>

#include "trocar/contours/contour_morph.h"
#include "trocar/contours/edge_adaption.h"
#include "trocar/contours/edge_field.h"

namespace trocar::contours {

/// Closed contours of the slices between two contoured ones.
///
/// No point leaves the interpolated contour by more than adaption.skipped_shift_px; where no slice shows an
/// edge, the contours are the interpolated ones.
/// \param match     of the two contours
/// \param fields    (n) of the slices between them, at equal steps from the first contour to the second
/// \return (n) closed polylines [pixels], one a slice
/// \pre adaption.skipped_shift_px >= 0.5 (TROCAR_ASSERT)
std::vector<std::vector<math::Vec2>> FollowBetween(const ContourMatch& match,
                                                   std::span<const EdgeField> fields,
                                                   const EdgeAdaptionSettings& adaption);

/// How an organ goes on beyond its last contoured slice.
struct FollowedEnd {
  std::vector<std::vector<math::Vec2>> contours;  ///< of the next slices, outwards [pixels]
  /// The slice after them does not show the organ. Otherwise it is not known whether it does.
  bool is_ended = false;
};

/// Follows an organ outwards until its colours or its edges end.
///
/// \param last      field of the last contoured slice, and its contour (m) m >= 3 [pixels]
/// \param fields    (n) of the slices beyond, outwards
/// \param least_px  a contour narrower than this is the end [pixels], > 0
/// \pre adaption.skipped_shift_px >= 0.5 (TROCAR_ASSERT)
FollowedEnd FollowEnd(const EdgeField& last, std::span<const math::Vec2> contour,
                      std::span<const EdgeField> fields, double least_px,
                      const EdgeAdaptionSettings& adaption);

}  // namespace trocar::contours
