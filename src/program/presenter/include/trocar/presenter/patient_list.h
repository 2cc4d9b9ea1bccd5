// SPDX-License-Identifier: Apache-2.0
/// \file patient_list.h  Patients that can be operated on: the built-in one and those of the user's folder, each with a picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::presenter {

struct PatientEntry {
  std::filesystem::path folder;        ///< empty: the scene's own, built in
  std::string name;                    ///< "Visible Human, male", "Generated patient, seed 7"
  std::string about;                   ///< what is to be known, in one line
  std::filesystem::path picture;       ///< PNG; empty: none could be drawn
  std::optional<base::Error> problem;  ///< of one that cannot be operated on, with its remedy
};

/// "patients" of host::FindUserDataFolder(): each folder of it is a patient.
std::filesystem::path FindPatientsFolder();

/// The built-in patient first, then those of a folder, by name. What cannot be read is listed with its problem.
/// Pictures are drawn where they are missing, and kept in the user's cache.
/// \param chosen  a patient elsewhere that is listed, too; empty: none
/// \note Reads and draws: not on the window's thread.
std::vector<PatientEntry> ListPatients(const std::filesystem::path& folder,
                                       const std::filesystem::path& chosen = {});

/// Name of one for a title, without reading it: the folder's; "the built-in patient" of an empty path.
std::string ShortPatientName(const std::filesystem::path& folder);

}  // namespace trocar::presenter
