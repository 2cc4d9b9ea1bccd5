// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "trocar/base/state_hash.h"
#include "trocar/host/user_folder.h"
#include "trocar/store/store.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

bool IsPostgresUrl(std::string_view url) {
  return url.starts_with("postgresql://") || url.starts_with("postgres://");
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Whether it is libpq's other way of naming a server: "host=server user=trocar password=...".
bool IsKeywordString(std::string_view text) {
  static constexpr std::string_view kKeywords[] = {"host",
                                                   "hostaddr",
                                                   "port",
                                                   "dbname",
                                                   "user",
                                                   "password",
                                                   "passfile",
                                                   "service",
                                                   "options",
                                                   "sslmode",
                                                   "sslcert",
                                                   "sslkey",
                                                   "sslpassword",
                                                   "sslrootcert",
                                                   "connect_timeout",
                                                   "application_name",
                                                   "target_session_attrs"};
  const std::string lower = Lower(text);
  for (const std::string_view keyword : kKeywords) {
    for (std::size_t at = 0; (at = lower.find(keyword, at)) != std::string::npos; ++at) {
      const bool begins = at == 0 || std::isspace(static_cast<unsigned char>(lower[at - 1])) != 0 ||
                          lower[at - 1] == '?' || lower[at - 1] == '&';
      const std::size_t end = lower.find_first_not_of(" \t", at + keyword.size());
      if (begins && end != std::string::npos && lower[end] == '=') return true;
    }
  }
  return false;
}

/// Whether a part of it between slashes is "user:password@server".
bool HasCredentials(std::string_view text) {
  for (std::size_t at = text.find('@'); at != std::string_view::npos; at = text.find('@', at + 1)) {
    const std::size_t colon = text.rfind(':', at), slash = text.rfind('/', at);
    if (colon != std::string_view::npos && (slash == std::string_view::npos || slash < colon)) return true;
  }
  return false;
}

/// Whether it is an address and no path: "scheme://...", "postgresql:...", "user:password@server/database", "postgres//...@...".
bool IsAddress(std::string_view text) {
  const std::string lower = Lower(text);
  const bool is_path = lower.starts_with("./") || lower.starts_with("../") ||
                       (lower.starts_with("/") && !lower.starts_with("//"));
  if ((!is_path && HasCredentials(lower)) ||
      (lower.starts_with("postg") && lower.find('@') != std::string::npos))
    return true;
  if (lower.find("://") != std::string::npos || lower.find(":\\\\") != std::string::npos) return true;
  const std::size_t colon = lower.find(':'), slash = lower.find('/');
  if (colon == std::string::npos || slash < colon) return false;
  return lower.starts_with("postg") || lower.find('@', colon) < slash ||
         (lower.size() > colon + 1 && lower[colon + 1] == '/');
}

/// What of a URL may be shown: all but secrets, and whatever this program does not know to be none.
std::string WithoutSecrets(const std::string& text) {
  static constexpr std::string_view kShown[] = {"host",
                                                "hostaddr",
                                                "port",
                                                "dbname",
                                                "user",
                                                "sslmode",
                                                "connect_timeout",
                                                "application_name",
                                                "target_session_attrs"};
  const std::size_t query = text.find('?');
  if (query == std::string::npos) return text;
  std::string shown = text.substr(0, query);
  char before = '?';
  for (std::size_t at = query + 1; at < text.size();) {
    const std::size_t next = std::min(text.find('&', at), text.size());
    const std::string field = text.substr(at, next - at);
    if (std::find(std::begin(kShown), std::end(kShown), field.substr(0, field.find('='))) !=
        std::end(kShown)) {
      shown += before + field;
      before = '&';
    }
    at = next + 1;
  }
  return shown;
}

/// As older versions showed it: the folder's name is made of it.
std::string FolderText(const std::string& url) {
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

/// Never with the text itself: it may hold a password.
base::Error Refuse(const std::string& why) {
  return {base::ErrorCode::kUsage,
          "where the store lies (--store or TROCAR_STORE): " + why +
              "; a store is the path of a file, or postgresql://USER@SERVER/DATABASE, with the password in "
              "~/.pgpass"};
}

}  // namespace

bool Place::IsPostgres() const {
  return IsPostgresUrl(url);
}

std::string Place::Text() const {
  return IsPostgres() ? WithoutSecrets(FolderText(url)) : url;
}

base::Result<Place> FindPlace(std::string url) {
  if (url.empty()) {
    const char* variable = std::getenv("TROCAR_STORE");
    url = variable == nullptr ? "" : variable;
  }
  constexpr std::size_t kLongest = 4096;
  if (url.size() > kLongest) return Refuse("it is longer than any path");
  if (std::any_of(url.begin(), url.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }))
    return Refuse("it has a line end or another control character");
  Place place;
  if (IsPostgresUrl(url)) {
    place.url = std::move(url);
    base::StateHash hash;
    for (const char byte : FolderText(place.url))
      hash.Add(static_cast<std::uint64_t>(static_cast<unsigned char>(byte)));
    place.folder = host::FindUserDataFolder() / "store" / ("centre-" + hash.Text());
    return place;
  }
  if (IsKeywordString(url)) return Refuse("it is a list of keywords, as libpq takes them");
  if (IsAddress(url)) return Refuse("it looks like an address, but does not begin with postgresql://");
  const fs::path file = url.empty() ? host::FindUserDataFolder() / "store" / "store.sqlite" : fs::path(url);
  std::error_code failure;
  const fs::path absolute = fs::absolute(file, failure);
  place.url = failure ? file.string() : absolute.lexically_normal().string();
  place.folder = place.url + ".files";
  return place;
}

}  // namespace trocar::store
