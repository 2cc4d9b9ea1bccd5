// SPDX-License-Identifier: Apache-2.0
#include "reduced_contacts.h"

#include <algorithm>
#include <utility>

namespace trocar::rigid {
namespace {

constexpr double kOneNormal = 0.9998;  // cosine between normals that count as one: 1.1 degrees
constexpr std::size_t kFewPoints = 4;  // as many are all kept

}  // namespace

void ReducedContactWorld::performDiscreteCollisionDetection() {
  FindAllContacts();
  points_.clear();
  for (int m = 0; m < getDispatcher()->getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *getDispatcher()->getManifoldByIndexInternal(m);
    for (int p = 0; p < manifold.getNumContacts(); ++p) points_.push_back({&manifold, p});
  }
  const auto bodies = [](const Point& point) {
    return std::pair(point.manifold->getBody0()->getBroadphaseHandle()->m_uniqueId,
                     point.manifold->getBody1()->getBroadphaseHandle()->m_uniqueId);
  };
  // stable: between equals Bullet's order decides, which is the same where a state was restored
  std::stable_sort(points_.begin(), points_.end(),
                   [&](const Point& x, const Point& y) { return bodies(x) < bodies(y); });
  for (std::size_t first = 0, end = 0; first < points_.size(); first = end) {
    while (end < points_.size() && bodies(points_[end]) == bodies(points_[first])) ++end;
    MarkOutermost(first, end);
  }
  // a manifold's last point moves to the place of one that is taken out
  std::stable_sort(points_.begin(), points_.end(),
                   [](const Point& x, const Point& y) { return x.index > y.index; });
  for (const Point& point : points_)
    if (!point.is_kept) point.manifold->removeContactPoint(point.index);
}

/// \param first, end  in points_: those of two bodies
void ReducedContactWorld::MarkOutermost(std::size_t first, std::size_t end) {
  const auto at = [&](std::size_t i) -> const btManifoldPoint& {
    return points_[i].manifold->getContactPoint(points_[i].index);
  };
  const auto keep_least = [&](const auto& measure) {
    points_[*std::ranges::min_element(group_, {}, [&](std::size_t i) { return measure(at(i)); })].is_kept =
        true;
  };
  for (std::size_t leader = first; leader < end; ++leader) {
    if (points_[leader].is_sorted) continue;
    const btVector3 normal = at(leader).m_normalWorldOnB;
    group_.clear();
    for (std::size_t i = leader; i < end; ++i) {
      if (points_[i].is_sorted || at(i).m_normalWorldOnB.dot(normal) < kOneNormal) continue;
      points_[i].is_sorted = true;
      group_.push_back(i);
    }
    if (group_.size() <= kFewPoints) {
      for (const std::size_t i : group_) points_[i].is_kept = true;
      continue;
    }
    btVector3 along, across;
    btPlaneSpace1(normal, along, across);
    keep_least([](const btManifoldPoint& p) { return p.getDistance(); });
    for (const btVector3& way : {along, -along, across, -across})
      keep_least([&](const btManifoldPoint& p) { return p.getPositionWorldOnB().dot(way); });
  }
}

}  // namespace trocar::rigid
