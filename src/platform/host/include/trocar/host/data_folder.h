// SPDX-License-Identifier: Apache-2.0
/// \file data_folder.h  Where the delivered files are.
#pragma once

#include <filesystem>

#include "trocar/base/result.h"

namespace trocar::host {

/// Folder that holds assets/ and scenes/: TROCAR_DATA_DIR, else beside the program, else where it was built or installed.
/// \return kFileMissing with the places that were tried
base::Result<std::filesystem::path> FindDataFolder();

}  // namespace trocar::host
