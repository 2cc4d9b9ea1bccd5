// SPDX-License-Identifier: Apache-2.0
/// \file spring_law.h  Tension of a spring that stiffens with strain, and its linearisation.
///
/// With eps = (L - l) / l, the stiffness dT/dL is k up to eps_0 and k (1 + beta (eps^2 - eps_0^2)) beyond. Domain
/// facts 3.1 print k (1 + beta eps^2) for eps > 0.2; taken as it stands the stiffness jumps at eps_0, and taken as
/// a secant the force does too, so that some loads would have no equilibrium. Here force and stiffness are
/// continuous and grow as printed (docs/solver.md).
#pragma once

#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// True where a spring is stretched beyond the reach of Hooke's law.
inline bool IsStiffened(const SpringLaw& law, double rest_length, double length) noexcept {
  return law.stiffening > 0.0 && rest_length > 0.0 && length > rest_length * (1.0 + law.stiffening_strain);
}

/// T = k l (eps + beta (eps - eps_0)^2 (eps + 2 eps_0) / 3) beyond eps_0, k l eps below [N].
///
/// \param stiffness    k [N/m]
/// \param rest_length  l [m]
/// \param length       L [m]
/// \note Real-time safe.
inline double CalcSpringTension(const SpringLaw& law, double stiffness, double rest_length,
                                double length) noexcept {
  const double tension = stiffness * (length - rest_length);
  if (!IsStiffened(law, rest_length, length)) return tension;
  const double from = law.stiffening_strain, strain = length / rest_length - 1.0, beyond = strain - from;
  return tension + stiffness * rest_length * law.stiffening * beyond * beyond * (strain + 2.0 * from) / 3.0;
}

/// dT/dL [N/m].
inline double CalcSpringStiffness(const SpringLaw& law, double stiffness, double rest_length,
                                  double length) noexcept {
  if (!IsStiffened(law, rest_length, length)) return stiffness;
  const double strain = length / rest_length - 1.0, from = law.stiffening_strain;
  return stiffness * (1.0 + law.stiffening * (strain * strain - from * from));
}

/// Work of stretching it from its rest length [J].
inline double CalcSpringEnergy(const SpringLaw& law, double stiffness, double rest_length,
                               double length) noexcept {
  const double stretch = length - rest_length, energy = 0.5 * stiffness * stretch * stretch;
  if (!IsStiffened(law, rest_length, length)) return energy;
  const double from = law.stiffening_strain, strain = length / rest_length - 1.0, beyond = strain - from;
  // the integral of (eps - eps_0)^2 (eps + 2 eps_0) / 3
  return energy + stiffness * rest_length * rest_length * law.stiffening * beyond * beyond * beyond *
                      (beyond / 12.0 + from / 3.0);
}

/// The spring of Hooke's law that has the tension and the tangent stiffness of another at one length.
struct TangentSpring {
  double stiffness = 0;    ///< [N/m]
  double rest_length = 0;  ///< [m]
};

/// \param factor  share of the spring that is left, TissueState::spring_factor [-]
/// \note Real-time safe.
inline TangentSpring CalcTangentSpring(const SpringLaw& law, double factor, double stiffness,
                                       double rest_length, double length) noexcept {
  if (!IsStiffened(law, rest_length, length)) return {factor * stiffness, rest_length};
  const double tangent = CalcSpringStiffness(law, stiffness, rest_length, length);
  if (!(tangent > 0.0)) return {0.0, rest_length};
  return {factor * tangent, length - CalcSpringTension(law, stiffness, rest_length, length) / tangent};
}

}  // namespace trocar::tissue
