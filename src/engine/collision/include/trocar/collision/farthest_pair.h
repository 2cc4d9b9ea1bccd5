// SPDX-License-Identifier: Apache-2.0
/// \file farthest_pair.h  The two points of a group that are farthest apart.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.3.2, d(C_k, C_j) = max
/// d(U_t).
#pragma once

#include <cstdint>
#include <span>

#include "trocar/math/vector.h"

namespace trocar::collision {

/// Two points of a group by their indices, first < second.
struct FarthestPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  double squared_distance = 0;  ///< [m^2]
};

/// The true farthest pair of `members`; of equally far pairs the one whose (first, second) comes first.
///
/// Small groups are compared pair by pair. Larger ones are cut into boxes, and pairs of boxes whose farthest
/// corners lie closer than the best pair so far are left out. Rounding is monotonic, so that bound holds for
/// computed distances too and the answer has the same bits as FindFarthestPairBruteForce.
///
/// \param points   (n) all points [m], finite
/// \param members  (m) indices into points, ascending, m >= 2
/// \pre m >= 2 (TROCAR_ASSERT)
/// \note Not real-time safe: allocates.
FarthestPair FindFarthestPair(std::span<const math::Vec3> points, std::span<const std::uint32_t> members);

}  // namespace trocar::collision
