// SPDX-License-Identifier: Apache-2.0
/// \file sha256.h  SHA-256 of texts and files, by libsodium.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::host {

/// \return 64 hexadecimal digits
std::string CalcSha256(std::string_view text);

/// Of a file's bytes, read in pieces.
/// \return kFileMissing where it cannot be opened, kFileUnreadable where it cannot be read to its end
base::Result<std::string> CalcSha256OfFile(const std::filesystem::path& file);

}  // namespace trocar::host
