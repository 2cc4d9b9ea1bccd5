// SPDX-License-Identifier: Apache-2.0
/// \file operation_level_file.h  Levels of an operation as assets/operation/levels.json holds them (schemas/operation-levels.schema.json).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/scene/operation_level.h"

namespace trocar::files {

/// Where they lie in the data folder.
inline constexpr const char* kOperationLevelsFile = "assets/operation/levels.json";

/// \return the file's error: kFileMissing, kJsonSyntax or kJsonField with the place
base::Result<std::vector<scene::OperationLevel>> ReadOperationLevels(const std::filesystem::path& path);
/// Levels that are delivered with the program, the easiest first.
base::Result<std::vector<scene::OperationLevel>> ListOperationLevels();
/// \param key  empty: kNormalLevel
/// \return kUnknownName with those known
base::Result<scene::OperationLevel> FindOperationLevel(const std::string& key);

}  // namespace trocar::files
