// SPDX-License-Identifier: Apache-2.0
/// \file patient_surroundings.h  The parts of patient.json about what lies beside the operated organs, and whence they come: neighbours, ports, table, labels.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "trocar/host/json.h"
#include "trocar/patient/patient.h"

namespace trocar::files {

/// Neighbours without their meshes, ports, table and labels; complains in `root`.
void ReadSurroundings(const host::JsonView& root, patient::Patient& patient);

/// The top-level members that the patient needs for them, in their order; none for a patient without.
std::vector<std::pair<std::string, nlohmann::ordered_json>> MakeSurroundingsJson(
    const patient::Patient& patient);

}  // namespace trocar::files
