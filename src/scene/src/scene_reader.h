// SPDX-License-Identifier: Apache-2.0
/// \file scene_reader.h  Reading of scenes and tasks from text, and of a scene's fields, wherever in a document they stand.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/task.h"

namespace trocar::scene {

/// \param view    the scene's object in `document`
/// \param folder  that relative paths start from
/// \param level   of an operation
/// \return the document's first complaint, the patient's or the script's error
core::Result<Scene> ReadSceneFields(const core::JsonDocument& document, const core::JsonView& view,
                                    const std::filesystem::path& folder,
                                    const std::filesystem::path& patient_folder,
                                    const OperationLevel& level = {});

/// A document of the format "trocar-scene", or a task at its normal level.
/// \param source  its name in messages; relative paths start from its folder
core::Result<Scene> ParsePlainScene(const std::string& text, const std::filesystem::path& source,
                                    const std::filesystem::path& patient_folder, const OperationLevel& level);

/// \return as ReadTask
core::Result<Scene> ParseTask(std::string text, const std::filesystem::path& source,
                              const TaskChoice& choice);

}  // namespace trocar::scene
