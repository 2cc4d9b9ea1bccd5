// SPDX-License-Identifier: Apache-2.0
#include "organ_clearance.h"

#include <algorithm>
#include <cmath>

namespace trocar::agent {

OrganClearance::OrganClearance(std::span<const patient::Organ> organs,
                               std::span<const scene::SurfaceInfo> surfaces,
                               std::span<const math::Vec3> rest) {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const scene::SurfaceInfo& surface = surfaces[i];
    auto tree = collision::TriangleTree::Make(rest.subspan(surface.first_node, surface.node_count),
                                              organs[i].mesh.triangles);
    organs_.push_back(
        {tree.ok() ? std::move(*tree) : collision::TriangleTree(), surface.first_node, surface.node_count});
  }
}

void OrganClearance::Follow(const simulation::Snapshot& seen) {
  if (tick_ == seen.tick) return;
  tick_ = seen.tick;
  for (Organ& organ : organs_) organ.tree.Update(organ.PositionsIn(seen));
}

double OrganClearance::Find(const simulation::Snapshot& seen, const collision::Segment& segment) {
  Follow(seen);
  constexpr double kFar = 0.03;  // [m]
  double least = kFar;
  for (const Organ& organ : organs_) {
    const auto contact =
        organ.tree.FindNearestToSegment(organ.PositionsIn(seen), segment, {.max_distance = least});
    if (contact.nearest.Found()) least = std::min(least, std::sqrt(contact.nearest.squared_distance));
  }
  return least;
}

double OrganClearance::FindTo(std::size_t organ, const simulation::Snapshot& seen,
                              const collision::Segment& segment, double most) {
  Follow(seen);
  const Organ& one = organs_[organ];
  const auto nearest =
      one.tree.FindNearestToSegment(one.PositionsIn(seen), segment, {.max_distance = most}).nearest;
  return nearest.Found() ? std::sqrt(nearest.squared_distance) : most;
}

}  // namespace trocar::agent
