// SPDX-License-Identifier: Apache-2.0
/// \file edge_path.h  The edge along a closed curve, as one place beside each of the curve's rows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "edge_strip.h"
#include "trocar/contours/edge_adaption.h"
#include "trocar/contours/edge_field.h"

namespace trocar::contours {

/// Distance of an edge path's rows along the curve [pixels].
inline constexpr double kEdgeRowStep = 2.0;

/// A contour's edge.
struct EdgePath {
  ClosedCurve curve;                  ///< (rows) where it was looked for
  std::vector<math::Vec2> at;         ///< (rows) the edge beside each row [pixels]
  std::vector<std::uint8_t> is_edge;  ///< (rows) a clear edge is there
};

/// Where an edge is looked for.
struct EdgeSearch {
  double reach_px = 0;  ///< to either side of the curve, >= 0.5
  double nearness = 0;  ///< part of an edge's strength that is lost at the reach [-]
};

/// The best closed path along a curve on which the colours become unlike those inside.
EdgePath FollowEdge(const EdgeField& field, ClosedCurve curve, const EdgeSearch& search,
                    const EdgeAdaptionSettings& settings);

/// Finds the edge within max_shift_px of a closed curve.
///
/// Found along the curve, and again twice in a narrow band along what was found, where the inside is known
/// better and the average along the curve blurs nothing; then located in the picture without blur.
/// \param curve  rows kEdgeRowStep apart; they are the path's rows
EdgePath FindEdgePath(const EdgeField& field, ClosedCurve curve, const EdgeAdaptionSettings& settings);

}  // namespace trocar::contours
