// SPDX-License-Identifier: Apache-2.0
/// \file reduced_contacts.h  Fewer contacts where bodies lie flat on each other: a ring of sixteen capsules touches a board in
/// twenty points and more, and the outermost hold it as well.
#pragma once

#include <cstddef>
#include <vector>

#include "own_motion.h"

namespace trocar::rigid {

/// A world whose solver sees, of the points in which two bodies touch with one normal, the deepest and the outermost only.
/// A force at any other point of them is a sum of forces at these.
class ReducedContactWorld final : public OwnMotionWorld {
 public:
  using OwnMotionWorld::OwnMotionWorld;

  /// Finds the contacts that a step's solver sees: the deepest and the outermost only.
  void performDiscreteCollisionDetection() override;
  /// All, as Bullet finds them.
  void FindAllContacts() { btDiscreteDynamicsWorld::performDiscreteCollisionDetection(); }

 private:
  struct Point {
    btPersistentManifold* manifold = nullptr;
    int index = 0;  // in the manifold
    bool is_sorted = false, is_kept = false;
  };
  void MarkOutermost(std::size_t first, std::size_t end);

  std::vector<Point> points_;       // by their bodies
  std::vector<std::size_t> group_;  // of points_, with one normal
};

}  // namespace trocar::rigid
