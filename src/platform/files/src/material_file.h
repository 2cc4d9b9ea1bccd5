// SPDX-License-Identifier: Apache-2.0
/// \file material_file.h  Materials as a scene lists them: written out, or in files of their own with
/// sources.
#pragma once

#include <filesystem>
#include <vector>

#include "trocar/host/json.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// A scene's "materials", each with its figures, or {"organ": ..., "file": ...}; a file is read once.
///
/// \param folder  of the scene
/// \return the file's error; kJsonField when a figure has no source. Complains in the document about an organ named twice
base::Result<std::vector<scene::OrganMaterial>> ReadMaterials(const host::JsonView& scene,
                                                              const std::filesystem::path& folder);

}  // namespace trocar::files
