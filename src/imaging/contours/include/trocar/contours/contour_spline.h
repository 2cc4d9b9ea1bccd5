// SPDX-License-Identifier: Apache-2.0
/// \file contour_spline.h  Closed cubic spline through control points that stays close to their polygon.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, third and fourth step.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::contours {

/// How far a spline may swing out between two control points.
struct ContourSplineSettings {
  double max_bulge = 0.35;  ///< distance from the chord, as part of the chord's length [-]
  double step_px = 0.5;     ///< distance of the sampled points [pixels]
};

/// Whether two sides of a closed polygon that are no neighbours touch or cross. O(n^2).
bool CrossesItself(std::span<const math::Vec2> polygon);

/// Closed polyline along a spline.
struct ContourCurve {
  std::vector<math::Vec2> points;  ///< (m) [pixels]
  std::vector<std::size_t>
      segment;  ///< (m) the control point that each follows; each control point is on the curve
  std::vector<std::size_t> divided;  ///< control points after which the spline had to be divided, ascending
};

/// Samples the closed spline through `points`.
///
/// Where the spline overshoots (the curve swings further from a chord than max_bulge, or crosses itself
/// though the polygon does not) the segment is divided by a point beside the chord's middle and the spline
/// fitted again.
/// \param points  (n) n >= 3 distinct points [pixels]
/// \return closed polyline [pixels]; crosses itself only if the points' own polygon does
/// \pre n >= 3 (TROCAR_ASSERT)
std::vector<math::Vec2> FitContour(std::span<const math::Vec2> points,
                                   const ContourSplineSettings& settings = {});

/// As FitContour, with the control point that each point of the curve follows.
ContourCurve FitContourCurve(std::span<const math::Vec2> points, const ContourSplineSettings& settings = {});

}  // namespace trocar::contours
