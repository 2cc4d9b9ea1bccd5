// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/brute_force.h"

#include "branch_and_bound.h"
#include "trocar/base/assert.h"

namespace trocar::collision {

using math::Vec3;

NearestTriangle FindNearestBruteForce(std::span<const Vec3> positions,
                                      std::span<const geometry::Triangle> triangles, const Vec3& p,
                                      double max_distance) noexcept {
  NearestTriangle best = StartSearch(max_distance);
  for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle) {
    ConsiderForPoint(positions, triangles[triangle], triangle, p, best);
  }
  return EndSearch(best);
}

std::uint32_t FindNearestCentroidBruteForce(std::span<const Vec3> centroids, const Vec3& p) noexcept {
  std::uint32_t nearest = kNoTriangle;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < centroids.size(); ++i) {
    const double d2 = math::SquaredDistance(centroids[i], p);
    if (d2 < nearest2) nearest = i, nearest2 = d2;
  }
  return nearest;
}

SegmentContact FindNearestToSegmentBruteForce(std::span<const Vec3> positions,
                                              std::span<const geometry::Triangle> triangles,
                                              const Segment& segment, double max_distance) noexcept {
  SegmentContact best;
  best.nearest = StartSearch(max_distance);
  for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle) {
    ConsiderForSegment(positions, triangles[triangle], triangle, segment, best);
  }
  best.nearest = EndSearch(best.nearest);
  return best;
}

FarthestPair FindFarthestPairBruteForce(std::span<const Vec3> points,
                                        std::span<const std::uint32_t> members) noexcept {
  TROCAR_ASSERT(members.size() >= 2);
  FarthestPair best{members[0], members[1], -1.0};
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) {
      const double d2 = math::SquaredDistance(points[members[i]], points[members[j]]);
      if (d2 > best.squared_distance) best = {members[i], members[j], d2};
    }
  }
  return best;
}

}  // namespace trocar::collision
