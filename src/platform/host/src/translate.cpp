// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/translate.h"

#include <libintl.h>

#include <algorithm>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

#include "catalogue.h"

#include "trocar/host/program.h"
namespace trocar::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDomain = "trocar";
constexpr int kDeepestComposition = 12;  // of texts within places of texts: a list's rest is one, too

// what TranslateComposed compares with, of the language that was last asked for
std::mutex patterns_guard;
std::filesystem::path catalogue_folder;
std::string patterns_language;
std::vector<CataloguePattern> patterns;

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
  std::error_code failure;
  for (const fs::path& place : {FindInstallationFolder() / "share/locale", FindProgramFolder() / "locale"}) {
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
  {
    const std::lock_guard lock(patterns_guard);
    catalogue_folder = folder;
    patterns_language.clear();
  }
  bindtextdomain(kDomain, folder.c_str());
  bind_textdomain_codeset(kDomain, "UTF-8");
  textdomain(kDomain);
}

std::string Translate(std::string_view text) {
  if (text.empty()) return {};
  const std::string english(text);
  // gettext would end it at a zero byte: somebody's text, none of the catalogue
  if (english.find('\0') != std::string::npos) return english;
  return dgettext(kDomain, english.c_str());
}

std::string TranslateIn(std::string_view context, std::string_view text) {
  const std::string key = std::string(context) + '\004' + std::string(text);
  const char* found = dgettext(kDomain, key.c_str());
  return found == key.c_str() ? std::string(text) : found;
}

std::string TranslateWith(std::string_view pattern, std::initializer_list<std::string_view> values) {
  return TranslateWith(pattern, std::span(values.begin(), values.size()));
}

std::string TranslateWith(std::string_view pattern, std::span<const std::string_view> values) {
  const std::string text = Translate(pattern);
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    const bool is_place = text[at] == '{' && at + 2 < text.size() && text[at + 2] == '}' &&
                          text[at + 1] >= '1' && text[at + 1] <= '9';
    const std::size_t place = is_place ? static_cast<std::size_t>(text[at + 1] - '1') : values.size();
    if (place < values.size()) {
      filled += values[place];
      at += 3;
    } else {
      filled += text[at++];
    }
  }
  return filled;
}

std::string TranslateCount(const char* one, const char* many, std::size_t count) {
  const std::string text = dngettext(kDomain, one, many, count);
  const std::string number = std::to_string(count);
  const std::size_t place = text.find("{1}");
  return place == std::string::npos ? text : text.substr(0, place) + number + text.substr(place + 3);
}

namespace {

bool IsPlainNumber(std::string_view text) {
  return !text.empty() && text.find_first_not_of("-0123456789.") == std::string_view::npos &&
         text.find('.') == text.rfind('.');
}

/// A pattern with fewer letters says little of what the text is.
constexpr std::size_t kWeakLetters = 10;

/// Several words, as names of things and people have none: a letter before each of two spaces.
bool IsSentence(std::string_view text) {
  return std::count(text.begin(), text.end(), ' ') >= 2;
}

std::string TranslateComposed(std::string_view text, int depth) {
  if (std::string exact = Translate(text); exact != text || depth == 0) return exact;
  for (const CataloguePattern& pattern : patterns) {
    if (auto places = MatchPattern(pattern, text)) {
      bool is_garbled = false;
      for (auto& [name, value] : *places) {
        std::string own = IsPlainNumber(value) ? LocalNumber(value) : TranslateComposed(value, depth - 1);
        // "{1}, {2} to {3}" is found in many a sentence: what stays in English there was none of the pattern
        is_garbled = is_garbled || (pattern.letters < kWeakLetters && own == value && IsSentence(value));
        value = std::move(own);
      }
      if (!is_garbled) return FillPattern(pattern.translation, *places);
    }
  }
  return std::string(text);
}

}  // namespace

std::string TranslateComposed(std::string_view text) {
  if (text.empty()) return {};
  const std::lock_guard lock(patterns_guard);
  // the catalogue's own name for the language that gettext has chosen
  if (const std::string language = Translate("en"); language != patterns_language) {
    patterns_language = language;
    patterns.clear();
    if (language != "en")
      patterns = ReadPatterns(catalogue_folder / language / "LC_MESSAGES" / (std::string(kDomain) + ".mo"));
  }
  return TranslateComposed(text, kDeepestComposition);
}

std::string TranslatePieces(std::string_view text) {
  if (std::string whole = TranslateComposed(text); whole != text) return whole;
  constexpr std::string_view kSeparators[] = {": ", ", ", "; ", "."};
  std::string translated;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = text.size(), length = 0;
    for (const std::string_view separator : kSeparators) {
      const std::size_t found = text.find(separator, at);
      if (found < end) end = found, length = separator.size();
    }
    if (end > at) translated += TranslateComposed(text.substr(at, end - at));
    translated += text.substr(end, length);
    at = end + length;
  }
  return translated;
}

std::string LocalNumber(std::string number) {
  const std::string mark = Translate(".");
  if (const std::size_t point = number.find('.'); point != std::string::npos && mark != ".")
    number.replace(point, 1, mark);
  return number;
}

std::string LocalCount(std::uint64_t count) {
  // a comma between groups would be read as the decimal mark
  const char* const between = Translate(".") == "." ? "," : "\u00a0";
  std::string text = std::to_string(count);
  for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), between);
  return text;
}

std::string ShownText(const base::Error& error) {
  return std::string(base::CodeText(error.code)) + " " + TranslateComposed(error.message);
}

std::string TranslatedMeaning(base::ErrorCode code) {
  const std::string_view english = base::ErrorTable()[static_cast<std::size_t>(code)].meaning;
  std::string text = Translate(english);
  return text == english ? std::string() : text;
}

}  // namespace trocar::host
