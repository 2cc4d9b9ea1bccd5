// SPDX-License-Identifier: Apache-2.0
/// \file generate_patient.h  A plausible patient without any pictures, from a seed.
/// Source of the blends: Ricci, "A constructive geometry for computer graphics", The Computer Journal 1973;
/// the polynomial form is Quilez's.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Draws the parameters and builds the patient that they describe.
///
/// Liver and gallbladder are volumes of distances (blended ellipsoids, cut by the viscera below; a pear along
/// a curved axis in its fossa) that go through the same marching cubes, smoothing and decimation as pictures
/// do; regions, bed and landmarks are found by AssemblePatient, ducts and arteries placed by landmarks.
/// The patient lists every parameter, and the sizes measured on the result. The same seed and settings give
/// the same patient.
/// \param settings  see DrawParameters
/// \return the error of the settings, or of the step that failed
base::Result<patient::Patient> GeneratePatient(std::uint64_t seed,
                                               std::span<const ParameterSetting> settings = {});

}  // namespace trocar::anatomy
