// SPDX-License-Identifier: Apache-2.0
#include "hold_constraint.h"

#include "own_motion.h"

namespace trocar::rigid {

void HoldConstraint::getInfo1(btConstraintInfo1* info) {
  info->m_numConstraintRows = 6;
  info->nub = 0;
}

// Three rows of turns, three of ways, each along an axis of the carrier: speed of the carrier less that of the body = error x erp
// per step. The carrier's own speed is none of the solver's: it goes where the hand is.
void HoldConstraint::getInfo2(btConstraintInfo2* info) {
  const btTransform& X_world_carrier = m_rbA.getCenterOfMassTransform();
  const btTransform& X_world_body = m_rbB.getCenterOfMassTransform();
  const btTransform X_world_wanted = X_world_carrier * X_carrier_body_;
  const btVector3 way = X_world_body.getOrigin() - X_world_wanted.getOrigin();
  const btVector3 turn = TurnBetween(X_world_wanted.getRotation(), X_world_body.getRotation());
  const btVector3 from_carrier = X_world_wanted.getOrigin() - X_world_carrier.getOrigin();
  const btMatrix3x3& axes = X_world_wanted.getBasis();
  for (int row = 0; row < 6; ++row) {
    const int at = row * info->rowskip;
    const bool is_turn = row < 3;
    const btVector3 axis = axes.getColumn(row % 3);
    const btVector3 arm = from_carrier.cross(axis);
    for (int i = 0; i < 3; ++i) {
      if (is_turn) {
        info->m_J1angularAxis[at + i] = axis[i];
        info->m_J2angularAxis[at + i] = -axis[i];
      } else {
        info->m_J1linearAxis[at + i] = axis[i];
        info->m_J1angularAxis[at + i] = arm[i];
        info->m_J2linearAxis[at + i] = -axis[i];
      }
    }
    info->m_constraintError[at] = info->fps * erp_ * axis.dot(is_turn ? turn : way);
    info->m_lowerLimit[at] = -SIMD_INFINITY;
    info->m_upperLimit[at] = SIMD_INFINITY;
    info->cfm[at] = cfm_;
  }
}

}  // namespace trocar::rigid
