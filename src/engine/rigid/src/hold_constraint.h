// SPDX-License-Identifier: Apache-2.0
/// \file hold_constraint.h  Constraint by which a held body follows the jaws, as on springs and dampers in all six directions.
#pragma once

#include "bullet_units.h"

namespace trocar::rigid {

/// Draws a body to its place in the frame of a carrier, and turns it as the carrier turns.
class HoldConstraint final : public btTypedConstraint {
 public:
  HoldConstraint(btRigidBody& carrier, btRigidBody& body, const btTransform& X_carrier_body)
      : btTypedConstraint(FIXED_CONSTRAINT_TYPE, carrier, body), X_carrier_body_(X_carrier_body) {}

  const btTransform& PlaceInCarrier() const { return X_carrier_body_; }
  /// \param cfm, erp  constraint force mixing and error reduction in Bullet's units. Source: Smith, Open Dynamics Engine manual,
  ///   section 3.8.
  void Soften(double cfm, double erp) { cfm_ = cfm, erp_ = erp; }

  void getInfo1(btConstraintInfo1* info) override;
  void getInfo2(btConstraintInfo2* info) override;
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  btTransform X_carrier_body_;
  double cfm_ = 0, erp_ = 0;
};

}  // namespace trocar::rigid
