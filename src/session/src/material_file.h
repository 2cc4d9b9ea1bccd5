// SPDX-License-Identifier: Apache-2.0
/// \file material_file.h  Materials as a scene lists them: written out, or in files of their own with
/// sources.
#pragma once

#include <filesystem>

#include "trocar/core/json.h"
#include "trocar/session/scene.h"

namespace trocar::session {

/// One entry of a scene's "materials": its figures, or {"organ": ..., "file": ...}.
///
/// \param folder  of the scene
/// \return the file's error; kJsonField when a figure has no source
core::Result<OrganMaterial> ReadMaterial(const core::JsonView& view, const std::filesystem::path& folder);

}  // namespace trocar::session
