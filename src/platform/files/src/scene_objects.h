// SPDX-License-Identifier: Apache-2.0
/// \file scene_objects.h  Reading of a scene's "objects".
#pragma once

#include <vector>

#include "field_ranges.h"
#include "trocar/host/json.h"
#include "trocar/scene/scene_object.h"

namespace trocar::files {

/// Reads the list `key` of objects; complains in the view's document where one is wrong, or too many.
std::vector<scene::SceneObject> ReadObjects(const host::JsonView& scene, std::string_view key);

/// A point given in mm [m].
/// \param each  range of each of its parts [mm]
math::Vec3 ReadPointMm(const host::JsonView& view, std::string_view key,
                       host::NumberRange each = range::kPlaceMm);
/// A direction, each part of -1 to 1, as a unit vector; complains about one without length.
math::Vec3 ReadDirection(const host::JsonView& view, std::string_view key);

}  // namespace trocar::files
