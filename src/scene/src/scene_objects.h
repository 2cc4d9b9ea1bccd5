// SPDX-License-Identifier: Apache-2.0
/// \file scene_objects.h  Reading of a scene's "objects".
#pragma once

#include <vector>

#include "field_ranges.h"
#include "trocar/core/json.h"
#include "trocar/scene/scene_object.h"

namespace trocar::scene {

/// Reads the list `key` of objects; complains in the view's document where one is wrong, or too many.
std::vector<SceneObject> ReadObjects(const core::JsonView& scene, std::string_view key);

/// A point given in mm [m].
/// \param each  range of each of its parts [mm]
math::Vec3 ReadPointMm(const core::JsonView& view, std::string_view key,
                       core::NumberRange each = range::kPlaceMm);
/// A direction, each part of -1 to 1, as a unit vector; complains about one without length.
math::Vec3 ReadDirection(const core::JsonView& view, std::string_view key);

}  // namespace trocar::scene
