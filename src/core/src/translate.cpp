// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/translate.h"

#include <libintl.h>

#include <clocale>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "trocar/core/program.h"
namespace trocar::core {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDomain = "trocar";

/// "es" of "es_MX.UTF-8"; empty for none and for "C".
std::string LanguageOf(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr || *value == '\0' || std::strncmp(value, "C", 2) == 0 ||
      std::strncmp(value, "C.", 2) == 0 || std::strcmp(value, "POSIX") == 0)
    return {};
  return std::string(value).substr(0, std::string_view(value).find_first_of("_.@"));
}

}  // namespace

fs::path FindLocaleFolder() {
  if (const char* named = std::getenv("TROCAR_LOCALE_DIR"); named != nullptr && *named != '\0') return named;
  const fs::path folder = FindProgramFolder();
  std::error_code failure;
  for (const fs::path& place : {folder / "../share/locale", folder / "locale"}) {
    if (fs::exists(place / "es/LC_MESSAGES/trocar.mo", failure)) return place.lexically_normal();
  }
  return {};
}

void UseLanguage(const fs::path& folder) {
  if (folder.empty()) return;
  if (std::setlocale(LC_MESSAGES, "") == nullptr) std::setlocale(LC_MESSAGES, "C");
  const char* chosen = std::setlocale(LC_MESSAGES, nullptr);
  // where the system has not generated the locale that was asked for, gettext would look for nothing
  if (chosen == nullptr || std::strcmp(chosen, "C") == 0 || std::strcmp(chosen, "POSIX") == 0) {
    std::setlocale(LC_MESSAGES, "C.UTF-8");
    const char* language = std::getenv("LANGUAGE");
    for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"}) {
      if (language != nullptr && *language != '\0') break;
      if (const std::string own = LanguageOf(name); !own.empty()) {
        ::setenv("LANGUAGE", own.c_str(), 1);
        break;
      }
    }
  }
  bindtextdomain(kDomain, folder.c_str());
  bind_textdomain_codeset(kDomain, "UTF-8");
  textdomain(kDomain);
}

std::string Translate(std::string_view text) {
  if (text.empty()) return {};
  const std::string english(text);
  return dgettext(kDomain, english.c_str());
}

std::string TranslatedMeaning(ErrorCode code) {
  const std::string_view english = ErrorTable()[static_cast<std::size_t>(code)].meaning;
  std::string text = Translate(english);
  return text == english ? std::string() : text;
}

}  // namespace trocar::core
