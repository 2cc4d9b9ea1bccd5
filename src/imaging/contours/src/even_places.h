// SPDX-License-Identifier: Apache-2.0
/// \file even_places.h  Places at even distances around a closed polyline.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::contours {

/// `part` [0, 1] of the way from point `side` to the one after it.
struct PolylinePlace {
  std::size_t side = 0;
  double part = 0;
};

/// As many places as make the steps at most `step` long, but `fewest` to `most` of them; the first is point 0.
/// \param polyline  closed, at least 3 points
std::vector<PolylinePlace> FindEvenPlaces(std::span<const math::Vec2> polyline, double step,
                                          std::size_t fewest, std::size_t most);

}  // namespace trocar::contours
