// SPDX-License-Identifier: Apache-2.0
/// \file crossing_points.h  Where the two points of a crossing are.
#pragma once

#include <span>

#include "trocar/math/vector.h"
#include "trocar/rod/rod_contact.h"

namespace trocar::rod {

/// From the point on b to that on a [m].
inline math::Vec3 CalcApart(std::span<const math::Vec3> position, const RodCrossing& c) noexcept {
  return math::Lerp(position[c.a], position[c.a + 1], c.at_a) -
         math::Lerp(position[c.b], position[c.b + 1], c.at_b);
}

}  // namespace trocar::rod
