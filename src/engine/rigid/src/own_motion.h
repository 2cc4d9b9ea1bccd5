// SPDX-License-Identifier: Apache-2.0
/// \file own_motion.h  How bodies move, without the C library's sine, arc cosine and power, whose last bit differs from one
/// computer to the next. Bullet's own integration calls them; what is left of Bullet in a step adds, multiplies, divides and
/// takes square roots.
#pragma once

#include "bullet_units.h"

namespace trocar::rigid {

/// Where a body is after `dt` [s] at constant velocity [cm/s] and turn [rad/s, in world axes]. Of a turn beyond 45 degrees 45
/// count.
btTransform Move(const btTransform& X_world_body, const btVector3& velocity, const btVector3& turn,
                 double dt);

/// The shortest turn from one orientation to the other: axis times angle, 0 to pi [rad].
btVector3 TurnBetween(const btQuaternion& from, const btQuaternion& to);

/// The share `share` (0 to 1) of the shortest turn from one orientation to the other.
btQuaternion TurnPart(const btQuaternion& from, const btQuaternion& to, double share);

/// A world whose bodies move by Move(). Kinematic bodies have no velocity: who moves them sets their poses. It sweeps nothing:
/// steps are so short that no body passes another.
class OwnMotionWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

 protected:
  void predictUnconstraintMotion(btScalar dt) override;
  void integrateTransforms(btScalar dt) override;
  void createPredictiveContacts(btScalar) override {}
  void saveKinematicState(btScalar) override {}
};

/// A solver that pushes bodies out of each other by Move().
class OwnMotionSolver final : public btSequentialImpulseConstraintSolver {
 protected:
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int count,
                                         const btContactSolverInfo& info) override;
};

}  // namespace trocar::rigid
