// SPDX-License-Identifier: Apache-2.0
/// \file intelligent_scissors.h  The path along edges from a seed to wherever the mouse is.
/// Source: Mortensen and Barrett, "Intelligent scissors for image composition", SIGGRAPH 1995.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/images/image_stack.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

struct ScissorsSettings {
  double blur_px = 1.5;  ///< standard deviation of the Gaussian before the gradient [pixels], > 0
  int reach_px =
      200;  ///< paths are found within a square of this half width around the seed [pixels], 8 to 1000
  double crossing_weight = 0.43;   ///< cost of a pixel that is no ridge of the gradient [-], >= 0
  double direction_weight = 0.43;  ///< cost of going across the edge's direction [-], >= 0
  double gradient_weight = 0.14;   ///< cost of a weak gradient [-], >= 0
};

/// Shortest paths over the pixels of one slice, short where edges are strong.
class IntelligentScissors {
 public:
  /// Computes the cost of every pixel.
  /// \pre the picture is at least 3 x 3 (TROCAR_ASSERT)
  explicit IntelligentScissors(const images::ColorImage& image, const ScissorsSettings& settings = {});

  /// Finds the paths to all pixels within reach.
  /// \param seed  moved into the picture if outside [pixels]
  void SetSeed(const math::Vec2& seed);

  /// \param target  [pixels]; beyond reach, the path runs to the nearest pixel within reach and straight on
  /// \return from the seed's to the target's pixel, neighbouring pixels; empty before SetSeed
  /// \note a walk along the path: microseconds
  std::vector<math::Vec2> PathTo(const math::Vec2& target) const;

 private:
  void CalcCosts(const images::ColorImage& image);

  ScissorsSettings settings_;
  int width_, height_;
  std::vector<float> static_cost_;  // (height * width) crossing and gradient terms [-]
  std::vector<float> edge_x_,
      edge_y_;  // (height * width) unit direction along the edge, 0 where there is none
  // around the seed: step that leads to each pixel, and the square
  int x0_ = 0, y0_ = 0, window_width_ = 0, window_height_ = 0;
  int seed_x_ = 0, seed_y_ = 0;
  std::vector<std::uint8_t> came_from_;  // (window) 0 to 7: direction of the step, 8: the seed
};

/// The few points of a path that a polyline through them stays within `tolerance_px` of; first and last are
/// kept.
/// Source: Douglas and Peucker, "Algorithms for the reduction of the number of points", 1973.
///
/// \param path  (n) open polyline [pixels]; fewer than three points come back unchanged
std::vector<math::Vec2> SimplifyPath(std::span<const math::Vec2> path, double tolerance_px = 1.0);

}  // namespace trocar::contours
