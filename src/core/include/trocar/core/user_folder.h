// SPDX-License-Identifier: Apache-2.0
/// \file user_folder.h  Where a person's own files lie. Source: XDG Base Directory Specification.
#pragma once

#include <filesystem>

namespace trocar::core {

/// Devices' settings and the like: TROCAR_CONFIG_DIR, else XDG_CONFIG_HOME/trocar, else HOME/.config/trocar.
std::filesystem::path FindConfigFolder();
/// Recordings and the like: TROCAR_DATA_HOME, else XDG_DATA_HOME/trocar, else HOME/.local/share/trocar.
std::filesystem::path FindUserDataFolder();
/// What can be made again: TROCAR_CACHE_HOME, else XDG_CACHE_HOME/trocar, else HOME/.cache/trocar.
std::filesystem::path FindCacheFolder();

}  // namespace trocar::core
