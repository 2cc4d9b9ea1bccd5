// SPDX-License-Identifier: Apache-2.0
/// \file operation_parameters_file.h  An operation's tables as assets/operation/parameters.json holds them.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/base/result.h"
#include "trocar/scene/operation_parameters.h"

namespace trocar::files {

/// Where they lie in the data folder.
inline constexpr const char* kOperationParametersFile = "assets/operation/parameters.json";

/// Reads a table (schemas/operation.schema.json); every figure must be there.
/// \param patch  JSON merge patch (RFC 7386) on it; empty: none
/// \return the file's error: kFileMissing, kJsonSyntax or kJsonField with the place
base::Result<scene::OperationParameters> ReadOperationParameters(const std::filesystem::path& path,
                                                                 const std::string& patch = {});

}  // namespace trocar::files
