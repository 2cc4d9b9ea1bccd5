// SPDX-License-Identifier: Apache-2.0
/// \file find_scene.h  An operation or a task by its name or file; any scene by its text.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/base/result.h"
#include "trocar/files/task_file.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Something to do: an operation, or a task.
/// \param name_or_path  of an operation, the key of a delivered task, or a file of either
/// \param choice        level of a task or an operation; the seed is also that of the scene
/// \return kUnknownName where there is no such thing or level; else as ReadTask
base::Result<scene::Scene> FindScene(const std::string& name_or_path, const TaskChoice& choice = {});

/// Where something to do stands: what FindScene reads.
/// \return kUnknownName where there is no such thing
base::Result<std::filesystem::path> FindSceneFile(const std::string& name_or_path);

/// An operation, a task, or a scene to look at, from text that need not stand in a file.
/// \param source  its name in messages; relative paths inside start from its folder
base::Result<scene::Scene> ParseScene(const std::string& text, const std::filesystem::path& source,
                                      const TaskChoice& choice = {});

}  // namespace trocar::files
