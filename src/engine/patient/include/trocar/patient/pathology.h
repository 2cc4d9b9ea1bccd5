// SPDX-License-Identifier: Apache-2.0
/// \file pathology.h  Effect of the patient's listed diseases on the tissue: factors on materials, adhesions, bleeding.
/// docs/patients.md gives the sources.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>

#include "trocar/patient/patient.h"
#include "trocar/roles/roles.h"

namespace trocar::patient {

/// Multiplies one material's constants.
struct MaterialFactors {
  double young_modulus = 1, wall_thickness = 1, foundation_modulus = 1, density = 1;

  friend bool operator==(const MaterialFactors&, const MaterialFactors&) = default;
};

struct Pathology {
  std::array<MaterialFactors, std::size(roles::RoleNames<roles::TissueRole>::kNames)>
      factors;  ///< (TissueRole)
  /// Share of an organ's free wall near the one in whose bed it lies that has grown to it [0, 1].
  double adhesions = 0;
  /// How much more a bed bleeds where the organ is torn off it [-].
  double bed_bleeding = 1;

  MaterialFactors& Of(roles::TissueRole tissue) { return factors[static_cast<std::size_t>(tissue)]; }
  const MaterialFactors& Of(roles::TissueRole tissue) const {
    return factors[static_cast<std::size_t>(tissue)];
  }
  friend bool operator==(const Pathology&, const Pathology&) = default;
};

/// From the patient's parameters; a patient that lists none is healthy: every factor is exactly 1.
Pathology CalcPathology(const Patient& patient);

}  // namespace trocar::patient
