// SPDX-License-Identifier: Apache-2.0
/// \file patched_json.h  A JSON file of which some fields are replaced.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/core/json.h"

namespace trocar::scene {

/// \param patch  JSON merge patch (RFC 7386); empty: the file as it is
/// \return the file's or the patch's error
core::Result<core::JsonDocument> ReadPatched(const std::filesystem::path& path, const std::string& patch);

}  // namespace trocar::scene
