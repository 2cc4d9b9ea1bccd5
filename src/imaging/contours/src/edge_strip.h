// SPDX-License-Identifier: Apache-2.0
/// \file edge_strip.h  The band of a picture along a closed curve, straightened, and the best path through
/// it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "trocar/contours/edge_field.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// Points at equal steps along a closed curve, with unit normals that point outwards.
struct ClosedCurve {
  std::vector<math::Vec2> at, normal;  ///< (n) [pixels], [-]
};

/// \param polyline  (m) m >= 3 closed [pixels], of any sense of rotation, which is kept
/// \param step_px   distance of the points, > 0; at least 8 and at most `most` points are made
ClosedCurve ResampleClosed(std::span<const math::Vec2> polyline, double step_px, std::size_t most = 4000);

/// Closed curve of the given points, with their normals.
/// \param at  (n) n >= 3 points of a closed curve at about equal steps [pixels]
ClosedCurve MakeClosedCurve(std::vector<math::Vec2> at);

/// Twice the enclosed area by the length: the radius of a circle, half the width of a band [pixels].
double CalcHalfWidth(const ClosedCurve& curve);

/// Colours on a grid of offsets (columns) along the normals of a curve's points (rows).
struct EdgeStrip {
  std::size_t rows = 0;
  int reach = 0;                ///< columns to either side of the curve
  double step_px = 0.5;         ///< distance of columns [pixels]
  std::vector<Colour> colours;  ///< (rows * Columns()), column k at offset (k - reach) * step_px outwards

  int Columns() const { return 2 * reach + 1; }
  const Colour* Row(std::size_t row) const { return &colours[row * Columns()]; }
};

EdgeStrip SampleStrip(const EdgeField& field, const ClosedCurve& curve, double reach_px,
                      double step_px = 0.5);

/// Column of each row with the least total cost around the closed strip.
///
/// \param cost        (rows * columns) finite
/// \param bend_cost   of neighbouring rows that differ by one column; by d columns it is d^2 as much, >= 0
/// \param max_jump    columns that neighbouring rows may differ by, >= 1
/// Source: Amini, Weymouth, Jain, PAMI 1990; closed by a second lap that begins where the first passed.
std::vector<int> FindClosedPath(std::span<const float> cost, std::size_t rows, int columns, double bend_cost,
                                int max_jump);

}  // namespace trocar::contours
