// SPDX-License-Identifier: Apache-2.0
/// \file patient_file.h  A patient's folder: patient.json and one PLY file an organ or neighbour.
#pragma once

#include <filesystem>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::files {

/// Reads a patient folder: patient.json and one PLY file an organ or neighbour, in LPS millimetres; converted here, once,
/// to the world frame.
/// \return the file's error, or kPatientInvalid with what is inconsistent
base::Result<patient::Patient> ReadPatient(const std::filesystem::path& folder);

/// A patient as its folder has it, right or wrong.
struct UncheckedPatient {
  patient::Patient patient;              ///< an organ whose mesh cannot be read has none
  std::vector<base::Error> mesh_errors;  ///< (organs, then neighbours) kNone where the mesh was read
};

/// Reads what ReadPatient reads without CheckPatient, for those who look for what is wrong.
/// \return an error only where patient.json itself cannot be read
base::Result<UncheckedPatient> ReadPatientUnchecked(const std::filesystem::path& folder);

/// Writes the folder that ReadPatient reads; nothing is left behind when it fails.
base::Status WritePatient(const std::filesystem::path& folder, const patient::Patient& patient);

}  // namespace trocar::files
