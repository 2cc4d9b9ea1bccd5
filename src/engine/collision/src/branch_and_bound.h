// SPDX-License-Identifier: Apache-2.0
/// \file branch_and_bound.h  The search that all exact queries share, and the rule by which a triangle wins.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/collision/queries.h"
#include "trocar/collision/triangle_distance.h"

namespace trocar::collision {

/// Nothing found yet; squared_distance is the farthest that may be found.
inline NearestTriangle StartSearch(double max_distance) noexcept {
  NearestTriangle start;
  start.squared_distance = max_distance >= 0.0 ? max_distance * max_distance : -1.0;
  return start;
}

inline NearestTriangle EndSearch(const NearestTriangle& best) noexcept {
  return best.Found() ? best : NearestTriangle{};
}

/// Whether (d2, triangle) comes before what was found: nearer, or as near with a lower index.
inline bool Wins(double d2, std::uint32_t triangle, const NearestTriangle& best) noexcept {
  return d2 < best.squared_distance || (d2 == best.squared_distance && triangle < best.triangle);
}

inline void ConsiderForPoint(std::span<const math::Vec3> positions, const geometry::Triangle& corners,
                             std::uint32_t triangle, const math::Vec3& p, NearestTriangle& best) noexcept {
  const geometry::TrianglePoint found =
      geometry::FindNearestOnTriangle(p, positions[corners[0]], positions[corners[1]], positions[corners[2]]);
  const double d2 = math::SquaredDistance(found.point, p);
  if (Wins(d2, triangle, best)) best = {triangle, found.point, found.weights, d2};
}

inline void ConsiderForSegment(std::span<const math::Vec3> positions, const geometry::Triangle& corners,
                               std::uint32_t triangle, const Segment& segment,
                               SegmentContact& best) noexcept {
  const SegmentTrianglePoints found = FindNearestSegmentTriangle(
      segment.start, segment.end, positions[corners[0]], positions[corners[1]], positions[corners[2]]);
  if (!Wins(found.squared_distance, triangle, best.nearest)) return;
  best = {{triangle, found.on_triangle.point, found.on_triangle.weights, found.squared_distance},
          found.parameter,
          found.on_segment};
}

/// Contact of a capsule, from the triangle nearest to its axis.
inline CapsuleContact MakeCapsuleContact(const SegmentContact& axis, double radius) noexcept {
  CapsuleContact contact;
  contact.axis = axis;
  if (!contact.Found()) return contact;
  const math::Vec3 towards = math::Normalized(axis.nearest.point - axis.on_segment, {0, 0, 0});
  contact.distance = std::sqrt(axis.nearest.squared_distance) - radius;
  contact.on_capsule = axis.on_segment + radius * towards;
  return contact;
}

/// Visits leaves, the nearer child first, and leaves out every node that the bound excludes.
///
/// \param calc_bound  (box) -> no point in the box is nearer than this [m^2]
/// \param limit       (by reference) nodes with a bound above it are left out [m^2]; visit may lower it
/// \param visit       (triangle) called for every leaf that is not excluded
template <typename CalcBound, typename Visit>
void SearchNearestFirst(const CentroidHierarchy& hierarchy, const double& limit, CalcBound&& calc_bound,
                        Visit&& visit) noexcept {
  const std::span<const HierarchyNode> nodes = hierarchy.Nodes();
  const std::span<const geometry::Box> boxes = hierarchy.Boxes();
  if (nodes.empty() || calc_bound(boxes[0]) > limit) return;
  struct Waiting {
    std::uint32_t node;
    double bound;
  };
  std::array<Waiting, kMaxHierarchyDepth + 1> stack;
  int waiting = 0;
  std::uint32_t node = 0;
  for (;;) {
    if (nodes[node].IsLeaf()) {
      visit(nodes[node].triangle_k);
    } else {
      std::uint32_t near = nodes[node].first_child, far = near + 1;
      double near_bound = calc_bound(boxes[near]), far_bound = calc_bound(boxes[far]);
      if (far_bound < near_bound) std::swap(near, far), std::swap(near_bound, far_bound);
      if (!(far_bound > limit)) stack[waiting++] = {far, far_bound};
      if (!(near_bound > limit)) {
        node = near;
        continue;
      }
    }
    do {
      if (waiting == 0) return;
      --waiting;
    } while (stack[waiting].bound > limit);
    node = stack[waiting].node;
  }
}

}  // namespace trocar::collision
