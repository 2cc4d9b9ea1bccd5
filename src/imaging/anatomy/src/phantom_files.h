// SPDX-License-Identifier: Apache-2.0
/// \file phantom_files.h  A folder that is there whole or not at all.
#pragma once

#include <filesystem>
#include <functional>

#include "trocar/base/result.h"

namespace trocar::anatomy {

/// Calls `write` with a folder beside the target, and renames that when it is done.
/// \param write  makes the folder
/// \return kFileUnwritable where the target exists and is no empty folder, or the error of `write`
base::Status WriteNewFolder(const std::filesystem::path& target,
                            const std::function<base::Status(const std::filesystem::path&)>& write);

}  // namespace trocar::anatomy
