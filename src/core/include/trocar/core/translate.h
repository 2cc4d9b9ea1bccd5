// SPDX-License-Identifier: Apache-2.0
/// \file translate.h  Texts for people in their language, by gettext. Files, recordings and reports for programs stay English.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/core/error_codes.h"

namespace trocar::core {

/// Folder of catalogues (es/LC_MESSAGES/trocar.mo): TROCAR_LOCALE_DIR, else ../share/locale or locale beside the program; empty
/// where there is none.
std::filesystem::path FindLocaleFolder();

/// From now on texts are in the language that LANGUAGE, LC_ALL, LC_MESSAGES or LANG names, where there is a catalogue. Changes no
/// number: LC_NUMERIC stays. Call it before threads start.
/// \param folder  as FindLocaleFolder; empty: all stays English
void UseLanguage(const std::filesystem::path& folder);

/// The text in the chosen language, or itself where there is none. Never asks for the empty text, whose translation is the
/// catalogue's head.
/// \param text  English, as it stands in po/trocar.pot
std::string Translate(std::string_view text);

/// What an error's code means; empty while texts are not translated, because the message says it.
std::string TranslatedMeaning(ErrorCode code);

}  // namespace trocar::core
