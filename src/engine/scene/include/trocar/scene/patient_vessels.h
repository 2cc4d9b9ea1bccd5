// SPDX-License-Identifier: Apache-2.0
/// \file patient_vessels.h  The patient's ducts and arteries as a network with flow, and what each part of it is to the surgeon.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"
#include "trocar/roles/roles.h"
#include "trocar/scene/operation_parameters.h"
#include "trocar/surgery/vessel_map.h"

namespace trocar::scene {

/// The meaning of a network's parts.
struct VesselAnatomy {
  std::vector<roles::TubeRole> roles;  ///< of each vessel of the network
  /// From the confluence of the hepatic ducts, or from the aorta, along the flow to the vessel's upper end [m].
  std::vector<double> below_source;
  std::vector<bool> is_upstream_from;  ///< whether the vessel's `from` end is the upstream one
  std::optional<std::uint32_t> liver;  ///< junction where bile comes from
  std::optional<std::uint32_t> bowel;  ///< junction where it goes
  std::vector<std::uint32_t>
      hollow_organ;                    ///< junctions at a hollow organ: of its ducts, and of its arteries
  std::optional<std::uint32_t> aorta;  ///< junction where blood comes from
  std::optional<std::uint32_t> right_liver;  ///< junction that the right hepatic artery supplies
};

struct PatientVessels {
  surgery::VesselMap map;
  VesselAnatomy anatomy;
};

/// Tubes are divided where others join them. What leaves the scene is fed by the aorta or drained by the bowel, and
/// so is a duct that ends in another organ than the liver and a hollow one. A tube without a role is one that must stay.
/// \return kPatientInvalid where the ducts make no network
base::Result<PatientVessels> MakePatientVessels(const patient::Patient& patient,
                                                const VesselSupplies& supplies = {},
                                                const surgery::FluidTable& fluids = surgery::kBileAndBlood);

}  // namespace trocar::scene
