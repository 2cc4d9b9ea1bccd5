// SPDX-License-Identifier: Apache-2.0
/// \file operated_anatomy.h  Which organs, tubes and strands of a patient's tissue a scene's procedure is about.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/patient/patient.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/scene/scene.h"
#include "trocar/surgery/gallstone_spill.h"
#include "trocar/surgery/organ_attachment.h"
#include "trocar/surgery/vessels.h"

namespace trocar::simulation {

/// Organ that is taken out, and in whose bed it lies: among the surfaces, -1 where the procedure or the patient has none.
struct OperatedOrgans {
  std::int32_t organ = -1, host = -1;
};
OperatedOrgans FindOperatedOrgans(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces);
/// Where tubes leave that organ; null where the procedure or the patient has none.
const patient::Landmark* FindNeck(const scene::Scene& scene);

/// The patient's ducts and arteries among the nodes of its tissue.
/// \param map  of the patient: see scene::MakePatientVessels
/// \param spare_count  nodes for the ends of cuts
surgery::Vessels MakeVessels(surgery::VesselMap map, const patient::Patient& patient,
                             const scene::PatientTissue& tissue, std::uint32_t spare_count,
                             const surgery::VesselSettings& settings = {});

/// Strands and tubes that hold the organ that is taken out.
/// \param surfaces  organs, then tubes
/// \param strands   (strands)
surgery::OrganAttachment MakeAttachment(const scene::Scene& scene,
                                        std::span<const scene::SurfaceInfo> surfaces,
                                        std::span<const scene::StrandInfo> strands);

/// How many stones a patient has, and how large: by the patient's parameters, else by the scene.
surgery::GallstoneSettings FindGallstones(const scene::Scene& scene);
/// Gallstones of a scene; none where it has none.
/// \param surfaces, rest  bodies under which the omentum passes, on which stones come to lie
/// \return kMeshInvalid
base::Result<surgery::GallstoneSpill> MakeGallstones(const scene::Scene& scene,
                                                     std::span<const scene::SurfaceInfo> surfaces,
                                                     std::span<const math::Vec3> rest);

}  // namespace trocar::simulation
