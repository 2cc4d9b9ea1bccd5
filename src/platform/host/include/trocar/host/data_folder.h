// SPDX-License-Identifier: Apache-2.0
/// \file data_folder.h  Where the delivered files are.
#pragma once

#include <filesystem>

#include "trocar/base/result.h"

namespace trocar::host {

/// Folder that holds assets/ and scenes/: TROCAR_DATA_DIR, else beside the program, else where it was built or installed.
/// \return kFileMissing with the places that were tried
base::Result<std::filesystem::path> FindDataFolder();
/// Of a library that is delivered with files of its own: they are there, unless TROCAR_DATA_DIR names another place.
/// \note Before other threads ask.
void SetDataFolder(const std::filesystem::path& folder);

}  // namespace trocar::host
