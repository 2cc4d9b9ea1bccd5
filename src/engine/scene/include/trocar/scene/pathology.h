// SPDX-License-Identifier: Apache-2.0
/// \file pathology.h  Effect of the patient's listed diseases on the tissue: factors on the scene's materials,
/// and adhesions. docs/patients.md gives the sources.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// Multiplies one material's constants.
struct MaterialFactors {
  double young_modulus = 1, wall_thickness = 1, foundation_modulus = 1, density = 1;

  friend bool operator==(const MaterialFactors&, const MaterialFactors&) = default;
};

struct Pathology {
  MaterialFactors liver, gallbladder, bed, tubes;
  /// Share of the gallbladder's free wall near the liver that has grown to it [0, 1].
  double adhesions = 0;
  /// How much more the liver's bed bleeds where the gallbladder is torn off it [-].
  double bed_bleeding = 1;

  friend bool operator==(const Pathology&, const Pathology&) = default;
};

/// From the patient's parameters; a patient that lists none is healthy: every factor is exactly 1.
Pathology CalcPathology(const patient::Patient& patient);

/// The scene's materials with the factors on.
std::vector<OrganMaterial> CalcPatientMaterials(const Scene& scene, const Pathology& pathology);

/// Adhesions: strands between the gallbladder's wall outside of its bed and the liver's surface within 15 mm,
/// in patches that grow with the share.
/// \return pairs of gallbladder and liver vertices, ascending
std::vector<std::pair<std::uint32_t, std::uint32_t>> FindAdhesions(const patient::Patient& patient,
                                                                   double share);

}  // namespace trocar::scene
