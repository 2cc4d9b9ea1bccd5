// SPDX-License-Identifier: Apache-2.0
/// \file pathology.h  The patient's diseases in a scene's tissue: factors on its materials, and adhesions.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "trocar/patient/pathology.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// The scene's materials with the factors on.
std::vector<OrganMaterial> CalcPatientMaterials(const Scene& scene, const patient::Pathology& pathology);

/// Adhesions: strands between an organ's wall outside of its bed and the surface of the bed's organ within 15 mm,
/// in patches that grow with the share.
/// \return pairs of vertices of the organ and of its host, ascending; none where the patient lacks one of them
std::vector<std::pair<std::uint32_t, std::uint32_t>> FindAdhesions(const patient::Patient& patient,
                                                                   const patient::PatientBed& of,
                                                                   double share);

}  // namespace trocar::scene
