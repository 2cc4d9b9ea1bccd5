// SPDX-License-Identifier: Apache-2.0
/// \file cubic_spline.h  Interpolating cubic splines through points, closed or open.
/// Source: de Boor, "A Practical Guide to Splines", ch. IV; chord-length parameter.
#pragma once

#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::math {

enum class SplineEnds {
  kClosed,  ///< periodic: the curve returns to its first point with the same tangent and curvature
  kNatural  ///< open: no curvature at either end
};

/// Twice continuously differentiable curve through `points`, parameter = chord length.
///
/// In a plane, set z to 0. Coinciding neighbours are merged.
class CubicSpline {
 public:
  /// \param points  (n) n >= 3 distinct for kClosed, n >= 2 for kNatural
  /// \pre enough distinct points, all finite (TROCAR_ASSERT)
  /// \note Not real-time safe: allocates
  CubicSpline(std::span<const Vec3> points, SplineEnds ends);

  /// Sum of the chords: the parameter runs over [0, Length()].
  double Length() const { return knots_.back(); }
  /// Chord length at which each point (after merging) lies; a closed spline repeats its first point at the
  /// end.
  std::span<const double> Knots() const { return knots_; }
  /// Point at parameter s, clamped to [0, Length()].
  Vec3 Evaluate(double s) const;
  /// dPoint/ds at s.
  Vec3 EvaluateDerivative(double s) const;
  /// `count` points at equal steps of the parameter; a closed curve does not repeat its first point.
  std::vector<Vec3> Sample(int count) const;

 private:
  std::size_t FindSegment(double s) const;

  SplineEnds ends_;
  std::vector<double> knots_;     // m
  std::vector<Vec3> points_;      // m
  std::vector<Vec3> curvatures_;  // m second derivatives
};

}  // namespace trocar::math
