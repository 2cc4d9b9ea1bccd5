// SPDX-License-Identifier: Apache-2.0
/// \file script.h  Reading of scripts: keys relative to landmarks.
#pragma once

#include <filesystem>

#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Reads keys {"time_s", "left": {"at": LANDMARK, "offset_mm": [x, y, z], "spin_deg", "jaw_deg"}, "right":
/// ...}. A hand that a key leaves out stays as in the key before.
///
/// \return the file's error, kScriptInvalid (times that do not rise, first key without a hand) or
/// kUnknownName
base::Result<scene::Script> ReadScript(const std::filesystem::path& path, const patient::Patient& patient);

}  // namespace trocar::files
