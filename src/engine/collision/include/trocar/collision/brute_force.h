// SPDX-License-Identifier: Apache-2.0
/// \file brute_force.h  Searches that look at everything: the oracles beside the hierarchy.
#pragma once

#include <limits>
#include <span>

#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/collision/farthest_pair.h"
#include "trocar/collision/queries.h"

namespace trocar::collision {

/// Nearest triangle to a point by testing every triangle: bit for bit the result of CentroidHierarchy::FindNearest.
NearestTriangle FindNearestBruteForce(std::span<const math::Vec3> positions,
                                      std::span<const geometry::Triangle> triangles, const math::Vec3& p,
                                      double max_distance = std::numeric_limits<double>::infinity()) noexcept;

/// Index of the centroid that is nearest to p, the lowest of equally near ones: what FindGreedy tries to
/// find.
/// \return kNoTriangle for no centroid
std::uint32_t FindNearestCentroidBruteForce(std::span<const math::Vec3> centroids,
                                            const math::Vec3& p) noexcept;

/// Nearest triangle to a segment by testing every triangle: bit for bit the result of FindNearestToSegment.
SegmentContact FindNearestToSegmentBruteForce(
    std::span<const math::Vec3> positions, std::span<const geometry::Triangle> triangles,
    const Segment& segment, double max_distance = std::numeric_limits<double>::infinity()) noexcept;

/// Farthest pair of points by testing every pair: the result of FindFarthestPair.
/// \pre at least two members (TROCAR_ASSERT)
FarthestPair FindFarthestPairBruteForce(std::span<const math::Vec3> points,
                                        std::span<const std::uint32_t> members) noexcept;

}  // namespace trocar::collision
