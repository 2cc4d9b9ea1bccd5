// SPDX-License-Identifier: Apache-2.0
/// \file script.h  Reading of scripts: keys relative to landmarks.
#pragma once

#include <filesystem>

#include "trocar/anatomy/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// Reads keys {"time_s", "left": {"at": LANDMARK, "offset_mm": [x, y, z], "spin_deg", "jaw_deg"}, "right":
/// ...}. A hand that a key leaves out stays as in the key before.
///
/// \return the file's error, kScriptInvalid (times that do not rise, first key without a hand) or
/// kUnknownName
core::Result<Script> ReadScript(const std::filesystem::path& path, const anatomy::Patient& patient);

}  // namespace trocar::scene
