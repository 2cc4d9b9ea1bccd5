// SPDX-License-Identifier: Apache-2.0
/// \file axis.h  Marks of plot axes, and lines thinned out to what a picture can show.
#pragma once

#include <cstddef>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::report {

/// Marks from at or above `low` to at or below `high`, 1, 2 or 5 times a power of ten apart, about `wanted`
/// of them.
/// \pre low < high, wanted >= 2 (TROCAR_ASSERT)
std::vector<double> FindAxisMarks(double low, double high, int wanted);

/// Marks of a logarithmic axis between `low` and `high`: powers of ten, with 2 and 5 times them where they are few.
/// \pre 0 < low < high (TROCAR_ASSERT)
std::vector<double> FindLogMarks(double low, double high);

/// Marks of an axis of time: 1, 2, 5, 10, 15, 30 s, 1, 2, 5, 10, 15, 30 min apart, about `wanted` of them.
/// \pre seconds > 0, wanted >= 2 (TROCAR_ASSERT)
std::vector<double> FindTimeMarks(double seconds, int wanted);

/// At most `limit` points, keeping the lowest and highest of each stretch so that no peak is lost.
/// \pre limit >= 2 (TROCAR_ASSERT)
std::vector<math::Vec2> ThinOut(const std::vector<math::Vec2>& points, std::size_t limit);

}  // namespace trocar::report
