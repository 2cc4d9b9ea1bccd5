// SPDX-License-Identifier: Apache-2.0
/// \file header_text.h  Lines, words, numbers and units of the text headers of NRRD and MetaImage.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reader.h"

namespace trocar::images::import {

inline constexpr std::size_t kLongestHeader = 1 << 20;

/// Without blanks and line ends at either side.
std::string_view Trimmed(std::string_view text);
std::string LowerCase(std::string_view text);
std::vector<std::string_view> Words(std::string_view text, std::string_view separators = " \t,()");
/// Words, each in double quotes or without.
std::vector<std::string> QuotedWords(std::string_view text);

/// `word` in double quotes, for a message; only "?" of a word that is no plain name of a type, a unit or a field.
std::string Shown(std::string_view word);

/// \throw Failure kImageUndecodable naming `field`
double ParseNumber(std::string_view text, const char* field);
std::int64_t ParseWhole(std::string_view text, const char* field);
std::vector<double> ParseNumbers(std::string_view text, const char* field);

/// Length of a unit that a header names: mm, cm, dm, m, um, nm, inch and their long forms.
///
/// \return [mm]; nothing where the header leaves it open ("" and question marks)
/// \throw Failure kImageGeometryInvalid naming a unit that is none of them: programs that pass over units would convert it wrongly
std::optional<double> ParseUnitMm(std::string_view unit);

/// Sets the sides. \throw Failure kImageUndecodable or kImageTooLarge
void SetSides(const std::vector<std::int64_t>& sides, const Job& job, ImageHeader& header);

/// The file that holds the samples of a detached header: notes its name for the other program, which opens
/// it.
/// \param name  as the header has it: a path from the header's folder on, which must not leave that
/// \return whether it is there already
/// \throw Failure kImagePathUnsafe
bool FindDataFile(const Job& job, std::string_view name, ImageHeader& header);

}  // namespace trocar::images::import
