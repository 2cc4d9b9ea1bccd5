// SPDX-License-Identifier: Apache-2.0
/// \file material_file.h  Materials as a scene lists them: written out, or in files of their own with
/// sources.
#pragma once

#include <filesystem>
#include <vector>

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// A scene's "materials", each with its figures, or {"organ": ..., "file": ...}; a file is read once.
///
/// \param folder  of the scene
/// \return the file's error; kJsonField when a figure has no source. Complains in the document about an organ named twice
core::Result<std::vector<OrganMaterial>> ReadMaterials(const core::JsonView& scene,
                                                       const std::filesystem::path& folder);

}  // namespace trocar::scene
