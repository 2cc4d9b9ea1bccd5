// SPDX-License-Identifier: Apache-2.0
/// \file scene_reader.h  Reading of scenes and tasks from text, and of a scene's fields, wherever in a document they stand.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/files/task_file.h"
#include "trocar/host/json.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/task.h"

namespace trocar::files {

/// \param view    the scene's object in `document`
/// \param folder  that relative paths start from
/// \param level   of an operation
/// \return the document's first complaint, the patient's or the script's error
base::Result<scene::Scene> ReadSceneFields(const host::JsonDocument& document, const host::JsonView& view,
                                           const std::filesystem::path& folder,
                                           const std::filesystem::path& patient_folder,
                                           const scene::OperationLevel& level = {});

/// A document of the format "trocar-scene", or a task at its normal level.
/// \param source  its name in messages; relative paths start from its folder
base::Result<scene::Scene> ParsePlainScene(const std::string& text, const std::filesystem::path& source,
                                           const std::filesystem::path& patient_folder,
                                           const scene::OperationLevel& level);

/// \return as ReadTask
base::Result<scene::Scene> ParseTask(std::string text, const std::filesystem::path& source,
                                     const TaskChoice& choice);

}  // namespace trocar::files
