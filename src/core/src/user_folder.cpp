// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/user_folder.h"

#include <cstdlib>
#include <string>

namespace trocar::core {
namespace {

std::string ReadVariable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// \param own, shared  variables: of Trocar's folder, and of the folder that holds those of all programs
/// \param below_home   that folder where no variable names it
std::filesystem::path FindFolder(const char* own, const char* shared, const char* below_home) {
  if (const std::string folder = ReadVariable(own); !folder.empty()) return folder;
  if (const std::string folder = ReadVariable(shared); !folder.empty())
    return std::filesystem::path(folder) / "trocar";
  return std::filesystem::path(ReadVariable("HOME")) / below_home / "trocar";
}

}  // namespace

std::filesystem::path FindConfigFolder() {
  return FindFolder("TROCAR_CONFIG_DIR", "XDG_CONFIG_HOME", ".config");
}

std::filesystem::path FindUserDataFolder() {
  return FindFolder("TROCAR_DATA_HOME", "XDG_DATA_HOME", ".local/share");
}

std::filesystem::path FindCacheFolder() {
  return FindFolder("TROCAR_CACHE_HOME", "XDG_CACHE_HOME", ".cache");
}

}  // namespace trocar::core
