// SPDX-License-Identifier: Apache-2.0
/// \file translate.h  Texts for people in their language, by gettext. Files, recordings and reports for programs stay English.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "trocar/base/error_codes.h"
#include "trocar/base/result.h"

namespace trocar::host {

/// Folder of catalogues (es/LC_MESSAGES/trocar.mo): TROCAR_LOCALE_DIR, else ../share/locale or locale beside the program; empty
/// where there is none.
std::filesystem::path FindLocaleFolder();

/// From now on texts are in the language that LANGUAGE, LC_ALL, LC_MESSAGES or LANG names, where there is a catalogue. Changes no
/// number: LC_NUMERIC stays. Call it before threads start.
/// \param folder  as FindLocaleFolder; empty: all stays English
void UseLanguage(const std::filesystem::path& folder);

/// The text in the chosen language, or itself where there is none. Never asks for the empty text, whose translation is the
/// catalogue's head.
/// \param text  English, as it stands in po/es.po
std::string Translate(std::string_view text);

/// Marks a text of a table that Translate gets later, so that the check of texts finds it.
constexpr const char* Mark(const char* text) noexcept {
  return text;
}

/// Translate() of an English word with several translations: context tells which ("jaws", "open").
std::string TranslateIn(std::string_view context, std::string_view text);

/// The text in the chosen language with its places filled: TranslateWith("{1} of {2}", {done, all}).
/// \param pattern  English, with places {1} to {9}; a translation may order them anew
/// \param values   of {1}, {2}, ...; a place without one stays as it is
std::string TranslateWith(std::string_view pattern, std::initializer_list<std::string_view> values);
std::string TranslateWith(std::string_view pattern, std::span<const std::string_view> values);

/// One or many: TranslateCount("{1} clip", "{1} clips", 3). {1} is the count.
std::string TranslateCount(const char* one, const char* many, std::size_t count);

/// A text that was put together elsewhere: a message of an error, a goal of a task. Where the catalogue has not the text itself it is
/// compared with the catalogue's patterns, whose places ({1}, {each}) hold whatever stood there. Text that fills a place is
/// translated in the same way. The pattern with the longest fixed text wins. Itself where none fits.
/// \note Not real-time safe: searches the whole catalogue.
std::string TranslateComposed(std::string_view text);

/// TranslateComposed() of several pieces with ": ", ", ", "; " or "." between them, each with its own text in the catalogue.
std::string TranslatePieces(std::string_view text);

/// The number's text with the language's decimal mark: "9,81". Only for people; what a program reads keeps its point.
/// \param number  digits and at most one point, perhaps with a unit behind
std::string LocalNumber(std::string number);

/// Digits in groups of three: "12,345", in Spanish "12 345".
std::string LocalCount(std::uint64_t count);

/// "E-IMG-002" and the message in the chosen language, for a person.
std::string ShownText(const base::Error& error);

/// Meaning of an error's code in the chosen language; empty while texts are not translated, because the message says it.
std::string TranslatedMeaning(base::ErrorCode code);

}  // namespace trocar::host
