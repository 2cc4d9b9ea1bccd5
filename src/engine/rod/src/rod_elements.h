// SPDX-License-Identifier: Apache-2.0
/// \file rod_elements.h  Energy, gradient and second derivative of bending, twist and length, each over the few nodes it joins.
///
/// Sources: Bergou et al. 2008 (energies, gradient of the twist), Bergou et al. 2010 (second derivatives, references that follow in
/// time).
#pragma once

#include <array>

#include "band_matrix.h"
#include "trocar/math/symmetric3.h"
#include "trocar/math/vector.h"

namespace trocar::rod {

/// Of the unknowns of a joint: node before, angle of the segment before, node, angle of the segment behind, node behind. Rows of
/// the lower half of the second derivative only.
struct ElementDerivatives {
  double energy = 0;
  std::array<double, kElementUnknowns> gradient{};
  std::array<std::array<double, kElementUnknowns>, kElementUnknowns> stiffness{};
};

/// Two segments that meet in a node.
struct Joint {
  math::Vec3 before, behind;  // the segments as vectors [m]
  double bending = 0;         // E I over the node's reach [N m]
  double twisting = 0;        // G J over the node's reach [N m]
  double twist = 0;           // of the material from one segment to the next [rad]
};

/// Bending E I / (2 r) |kappa b|^2 and twist G J / (2 r) m^2 of a joint, added to `sum`.
///
/// \param has_stiffness  false: energy and gradient alone
void AddJoint(const Joint& joint, bool has_stiffness, ElementDerivatives& sum) noexcept;

/// A vector carried from one direction to another by the smallest turn.
///
/// \param from, to  unit vectors; where they are opposite, the vector stays as it is
math::Vec3 Transport(const math::Vec3& vector, const math::Vec3& from, const math::Vec3& to) noexcept;

/// Angle from u to v round the unit vector `axis`, -pi to pi [rad].
double CalcSignedAngle(const math::Vec3& u, const math::Vec3& v, const math::Vec3& axis) noexcept;

/// A vector square to the unit vector `axis`, turned round it.
math::Vec3 Turn(const math::Vec3& vector, const math::Vec3& axis, double angle) noexcept;

}  // namespace trocar::rod
