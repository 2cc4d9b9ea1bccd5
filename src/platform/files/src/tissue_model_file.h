// SPDX-License-Identifier: Apache-2.0
/// \file tissue_model_file.h  Reading of a scene's "model": tissue that a training task makes for itself.
#pragma once

#include "trocar/host/json.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Of a sheet's vertices: those that stay where they are.
inline constexpr const char* kHeldRegion = roles::NameOf(roles::RegionRole::kHeld);

/// Reads `model` into Scene::model and Scene::patient, and makes the scene an operation; complains in the view's
/// document.
void ReadTissueModel(const host::JsonView& view, scene::Scene& scene);

}  // namespace trocar::files
