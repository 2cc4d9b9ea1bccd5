// SPDX-License-Identifier: Apache-2.0
/// \file user_folder.h  Where a person's own files lie. Source: XDG Base Directory Specification.
#pragma once

#include <filesystem>
#include <system_error>

namespace trocar::host {

/// Devices' settings and the like: TROCAR_CONFIG_DIR, else XDG_CONFIG_HOME/trocar, else HOME/.config/trocar.
std::filesystem::path FindConfigFolder();
/// Recordings and the like: TROCAR_DATA_HOME, else XDG_DATA_HOME/trocar, else HOME/.local/share/trocar.
std::filesystem::path FindUserDataFolder();
/// Files that can be made again: TROCAR_CACHE_HOME, else XDG_CACHE_HOME/trocar, else HOME/.cache/trocar.
std::filesystem::path FindCacheFolder();

/// Makes a folder and those above it that are missing, each for its owner alone (0700), whatever the umask is. What is there stays as it is.
std::error_code MakePrivateFolders(const std::filesystem::path& folder);
/// MakePrivateFolders() for a folder inside of the three above; any other gets the rights that the umask leaves.
std::error_code MakeFolders(const std::filesystem::path& folder);

}  // namespace trocar::host
