// SPDX-License-Identifier: Apache-2.0
/// \file owner_file.h  Files that only their owner may read.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::assessment {

/// A new file with the mode 0600 from its first moment, synced.
/// \return kFileUnwritable, also where there is such a file already
base::Status WriteOwnerFile(const std::filesystem::path& path, std::string_view content);

/// \return kFileMissing, kFileUnreadable, kFileTooLarge; kKeyUnsafe where group or others may read or write it, or it is
/// another person's
base::Result<std::string> ReadOwnerFile(const std::filesystem::path& path);

}  // namespace trocar::assessment
