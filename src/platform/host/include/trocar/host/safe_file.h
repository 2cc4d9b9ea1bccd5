// SPDX-License-Identifier: Apache-2.0
/// \file safe_file.h  Reading with a size limit, and writing that never leaves half a file behind.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::host {

/// Whole content of a regular file.
///
/// \param limit_bytes  files larger than this are refused before anything is allocated
/// \return kFileMissing, kFileUnreadable (not a regular file, I/O error) or kFileTooLarge
base::Result<std::string> ReadFile(const std::filesystem::path& path, std::size_t limit_bytes = 64u << 20);

/// Writes `content` beside `path`, then renames it: a reader sees the old file or the new one, never a part.
/// Makes the parent folders.
/// \return kFileUnwritable
base::Status WriteFile(const std::filesystem::path& path, std::string_view content);

}  // namespace trocar::host
