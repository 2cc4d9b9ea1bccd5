// SPDX-License-Identifier: Apache-2.0
/// \file patient_surroundings.h  The parts of patient.json about what lies beside the operated organs, and whence they come: neighbours, ports, table, labels.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "trocar/anatomy/patient.h"
#include "trocar/core/json.h"

namespace trocar::anatomy {

/// Neighbours without their meshes, ports, table and labels; complains in `root`.
void ReadSurroundings(const core::JsonView& root, Patient& patient);

/// The top-level members that the patient needs for them, in their order; none for a patient without.
std::vector<std::pair<std::string, nlohmann::ordered_json>> MakeSurroundingsJson(const Patient& patient);

/// \param names  of the organs; those of the neighbours are added
/// \return kPatientInvalid, kMeshInvalid
core::Status CheckSurroundings(const Patient& patient, std::set<std::string>& names);

}  // namespace trocar::anatomy
