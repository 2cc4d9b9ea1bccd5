// SPDX-License-Identifier: Apache-2.0
/// \file patient_vessels.h  The patient's ducts and arteries as a network with flow, and what each part of it is to the surgeon.
#pragma once

#include "trocar/base/result.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/operation_parameters.h"
#include "trocar/surgery/vessel_map.h"

namespace trocar::scene {

struct PatientVessels {
  surgery::VesselMap map;
  cholecystectomy::BiliaryAnatomy anatomy;
};

/// Tubes are divided where others join them. What leaves the scene is fed by the aorta or drained by the bowel, and
/// so is a duct that ends in another organ than liver and gallbladder. A tube without a role is one that must stay.
/// \return kPatientInvalid where the ducts make no network
base::Result<PatientVessels> MakePatientVessels(const patient::Patient& patient,
                                                const VesselSupplies& supplies = {},
                                                const surgery::FluidTable& fluids = surgery::kBileAndBlood);

}  // namespace trocar::scene
