// SPDX-License-Identifier: Apache-2.0
/// \file contour_morph.h  Contours between two contours, by matching their points.
/// Source: Sakoe and Chiba, "Dynamic programming algorithm optimization for spoken word recognition", 1978
/// (time warping); for planar contours Fuchs, Kedem, Uselton, "Optimal surface reconstruction from planar
/// contours", 1977.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::contours {

/// Points of one contour beside the points of another that they belong to.
struct ContourMatch {
  std::vector<std::array<math::Vec2, 2>> pairs;  ///< closed, in the order of both contours

  /// Contour at the given part of the way from the first to the second [-].
  std::vector<math::Vec2> At(double part) const;
};

/// Matches two closed contours in order, so that near points with like normals belong together.
///
/// A thin lobe that moves sideways by more than its thickness from slice to slice keeps its length in
/// between.
/// \param a, b  closed polylines [pixels], n >= 3, of any sense of rotation
ContourMatch MatchContours(std::span<const math::Vec2> a, std::span<const math::Vec2> b);

}  // namespace trocar::contours
