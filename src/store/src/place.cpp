// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "trocar/core/state_hash.h"
#include "trocar/core/user_folder.h"
#include "trocar/store/store.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

bool IsPostgresUrl(const std::string& url) {
  return url.starts_with("postgresql://") || url.starts_with("postgres://");
}

}  // namespace

bool Place::IsPostgres() const {
  return IsPostgresUrl(url);
}

std::string Place::Text() const {
  if (!IsPostgres()) return url;
  std::string text = url;
  const std::size_t begin = text.find("://") + 3;
  // of "user:password@host" and "?password=..."
  const std::size_t end = text.find_first_of("/?", begin);
  std::size_t at = text.rfind('@', end);
  // a password with a "/" of its own is no address, and is not shown for all that
  if (at == std::string::npos || at < begin) at = text.rfind('@', text.find('?', begin));
  const std::size_t colon = text.find(':', begin);
  if (at != std::string::npos && at > begin && colon != std::string::npos && colon < at)
    text.erase(colon, at - colon);
  for (std::size_t field = 0; (field = text.find("password=")) != std::string::npos;) {
    const std::size_t next = text.find('&', field);
    text.erase(field, next == std::string::npos ? next : next + 1 - field);
  }
  return text;
}

Place FindPlace(std::string url) {
  if (url.empty()) {
    const char* variable = std::getenv("TROCAR_STORE");
    url = variable == nullptr ? "" : variable;
  }
  Place place;
  if (IsPostgresUrl(url)) {
    place.url = std::move(url);
    core::StateHash hash;
    for (const char byte : place.Text())
      hash.Add(static_cast<std::uint64_t>(static_cast<unsigned char>(byte)));
    place.folder = core::FindUserDataFolder() / "store" / ("centre-" + hash.Text());
    return place;
  }
  const fs::path file = url.empty() ? core::FindUserDataFolder() / "store" / "store.sqlite" : fs::path(url);
  std::error_code failure;
  const fs::path absolute = fs::absolute(file, failure);
  place.url = failure ? file.string() : absolute.lexically_normal().string();
  place.folder = place.url + ".files";
  return place;
}

}  // namespace trocar::store
