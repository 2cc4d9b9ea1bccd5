// SPDX-License-Identifier: Apache-2.0
#include "own_motion.h"

#include <cmath>
#include <numbers>

#include "trocar/math/elementary.h"

namespace trocar::rigid {
namespace {

constexpr double kMostTurn = 0.25 * std::numbers::pi;  // in one step [rad]

/// sin(angle / 2) / angle
double HalfSineOver(double angle) {
  return angle > 0 ? math::Sin(0.5 * angle) / angle : 0.5;
}

btQuaternion RotationBy(const btVector3& turn) {
  const double angle = turn.length();
  const btVector3 part = turn * HalfSineOver(angle);
  return {part.x(), part.y(), part.z(), math::Cos(0.5 * angle)};
}

}  // namespace

btTransform Move(const btTransform& X_world_body, const btVector3& velocity, const btVector3& turn,
                 double dt) {
  btVector3 turned = turn * dt;
  const double angle = turned.length();
  if (angle > kMostTurn) turned *= kMostTurn / angle;
  btQuaternion rotation = RotationBy(turned) * X_world_body.getRotation();
  rotation.safeNormalize();
  return btTransform(rotation, X_world_body.getOrigin() + velocity * dt);
}

btVector3 TurnBetween(const btQuaternion& from, const btQuaternion& to) {
  btQuaternion between = to * from.inverse();
  if (between.w() < 0) between = -between;
  const btVector3 axis(between.x(), between.y(), between.z());
  const double sine = axis.length();
  const double angle = 2.0 * math::Atan2(sine, between.w());
  return axis * (sine > 0 ? angle / sine : 2.0);
}

btQuaternion TurnPart(const btQuaternion& from, const btQuaternion& to, double share) {
  btQuaternion rotation = RotationBy(TurnBetween(from, to) * share) * from;
  rotation.safeNormalize();
  return rotation;
}

void OwnMotionWorld::predictUnconstraintMotion(btScalar dt) {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
    btRigidBody& body = *m_nonStaticRigidBodies[i];
    if (body.isStaticOrKinematicObject()) continue;
    // damping is the share of the speed that is lost in a second
    body.setLinearVelocity(body.getLinearVelocity() * math::Pow(1.0 - body.getLinearDamping(), dt));
    body.setAngularVelocity(body.getAngularVelocity() * math::Pow(1.0 - body.getAngularDamping(), dt));
    body.setInterpolationWorldTransform(
        Move(body.getWorldTransform(), body.getLinearVelocity(), body.getAngularVelocity(), dt));
  }
}

void OwnMotionWorld::integrateTransforms(btScalar dt) {
  for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
    btRigidBody& body = *m_nonStaticRigidBodies[i];
    if (!body.isActive() || body.isStaticOrKinematicObject()) continue;
    body.proceedToTransform(
        Move(body.getWorldTransform(), body.getLinearVelocity(), body.getAngularVelocity(), dt));
  }
}

btScalar OwnMotionSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int count,
                                                        const btContactSolverInfo& info) {
  for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
    btSolverBody& body = m_tmpSolverBodyPool[i];
    if (body.m_originalBody == nullptr || (body.m_pushVelocity.isZero() && body.m_turnVelocity.isZero()))
      continue;
    body.m_worldTransform = Move(body.m_worldTransform, body.m_pushVelocity,
                                 body.m_turnVelocity * info.m_splitImpulseTurnErp, info.m_timeStep);
    // Bullet would move it once more
    body.m_pushVelocity.setZero();
    body.m_turnVelocity.setZero();
  }
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, count, info);
}

}  // namespace trocar::rigid
