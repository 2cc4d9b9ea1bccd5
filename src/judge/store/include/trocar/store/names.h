// SPDX-License-Identifier: Apache-2.0
/// \file names.h  Names behind the pseudonyms: one file on this computer that only its owner may read, and nothing else.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::store {

/// Pseudonym to name; any bytes.
using Names = std::map<std::string, std::string, std::less<>>;

/// Empty where there is no file.
/// \return kFileUnreadable, kJsonSyntax; kStoreRefused where others may read the file: its rights must be put right first
base::Result<Names> ReadNames(const std::filesystem::path& path);
/// One change; other programs' changes are kept. \param name  empty: none any more
base::Status SetName(const std::filesystem::path& path, std::string_view pseudonym, std::string_view name);
/// The name moves to another pseudonym.
base::Status MoveName(const std::filesystem::path& path, std::string_view from, std::string_view to);

}  // namespace trocar::store
