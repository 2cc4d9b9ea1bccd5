// SPDX-License-Identifier: Apache-2.0
/// \file scene_file.h  Scenes as scenes/*.json hold them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Reads a scene with its patient and script, or a task at its normal level. Paths inside are relative to the file.
/// \param patient_folder  takes the place of the scene's own patient unless it is empty
/// \return the file's error, kSceneInvalid, kScriptInvalid or kUnknownName
base::Result<scene::Scene> ReadScene(const std::filesystem::path& path,
                                     const std::filesystem::path& patient_folder = {});

/// The scene of that name, or at that path, where it is an operation.
/// \param level  of ListOperationLevels; empty: kNormalLevel
/// \return nothing where there is none: then it is a task; the file's error where it is one that cannot be read; kUnknownName
///         where there is no such level
base::Result<std::optional<scene::Scene>> FindOperation(const std::string& name,
                                                        const std::filesystem::path& patient_folder,
                                                        std::uint64_t seed, const std::string& level = {});

}  // namespace trocar::files
