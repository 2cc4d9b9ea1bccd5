// SPDX-License-Identifier: Apache-2.0
/// \file patched_json.h  JSON of which some fields are replaced.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/host/json.h"

namespace trocar::files {

/// \param source  name used in messages
/// \param patch   JSON merge patch (RFC 7386); empty: the text as it is
/// \return the text's or the patch's error
base::Result<host::JsonDocument> ParsePatched(const std::string& text, const std::string& source,
                                              const std::string& patch);
/// ParsePatched() of a file. \return its error, too
base::Result<host::JsonDocument> ReadPatched(const std::filesystem::path& path, const std::string& patch);

}  // namespace trocar::files
