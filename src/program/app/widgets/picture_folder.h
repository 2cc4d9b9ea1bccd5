// SPDX-License-Identifier: Apache-2.0
/// \file picture_folder.h  Where the windows put pictures and clips.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/base/result.h"

namespace trocar::app {

/// A new name in the user's folder for pictures, which is made where it is missing.
/// \param ending  ".png"
/// \return kFileUnwritable where the folder cannot be made
base::Result<std::filesystem::path> MakePictureName(const std::string& ending);

}  // namespace trocar::app
