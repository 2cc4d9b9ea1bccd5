// SPDX-License-Identifier: Apache-2.0
/// \file scene_reader.h  Reading of a scene's fields, wherever in a document they stand.
#pragma once

#include <filesystem>

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// \param view    the scene's object in `document`
/// \param folder  that relative paths start from
/// \param level   of an operation
/// \return the document's first complaint, the patient's or the script's error
core::Result<Scene> ReadSceneFields(const core::JsonDocument& document, const core::JsonView& view,
                                    const std::filesystem::path& folder,
                                    const std::filesystem::path& patient_folder,
                                    const OperationLevel& level = {});

}  // namespace trocar::scene
