// SPDX-License-Identifier: Apache-2.0
/// \file program_folder.h  Where this program lies.
#pragma once

#include <filesystem>

namespace trocar::cli {

/// Folder of the running program; "." where the system does not say.
std::filesystem::path FindProgramFolder();

}  // namespace trocar::cli
