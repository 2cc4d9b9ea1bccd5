// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/user_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>

namespace trocar::host {
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

/// Whether `path` is `folder`, or below it.
bool IsInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto [end, unused] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
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

std::error_code MakePrivateFolders(const std::filesystem::path& folder) {
  std::error_code failure;
  if (folder.empty() || std::filesystem::is_directory(folder, failure)) return {};
  if (folder.has_parent_path() && folder.parent_path() != folder) {
    if (const auto above = MakePrivateFolders(folder.parent_path())) return above;
  }
  // another program may have been first
  if (::mkdir(folder.c_str(), S_IRWXU) == 0 || std::filesystem::is_directory(folder, failure)) return {};
  return {errno == 0 ? EIO : errno, std::generic_category()};
}

std::error_code MakeFolders(const std::filesystem::path& folder) {
  std::error_code failure;
  const auto whole = std::filesystem::absolute(folder, failure).lexically_normal();
  for (const auto& own : {FindConfigFolder(), FindUserDataFolder(), FindCacheFolder()}) {
    if (IsInside(whole, std::filesystem::absolute(own, failure).lexically_normal()))
      return MakePrivateFolders(folder);
  }
  std::filesystem::create_directories(folder, failure);
  return failure;
}

}  // namespace trocar::host
