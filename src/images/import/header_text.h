// SPDX-License-Identifier: Apache-2.0
/// \file header_text.h  Lines, words and numbers of the text headers of NRRD and MetaImage.
#pragma once

#include <cstdint>
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

/// \throw Failure kImageUndecodable naming `field`
double ParseNumber(std::string_view text, const char* field);
std::int64_t ParseWhole(std::string_view text, const char* field);
std::vector<double> ParseNumbers(std::string_view text, const char* field);

/// Sets the sides. \throw Failure kImageUndecodable or kImageTooLarge
void SetSides(const std::vector<std::int64_t>& sides, const Job& job, ImageHeader& header);

/// The file that holds the samples of a detached header: notes its name for the other program, which opens
/// it.
/// \return whether it is there already
bool FindDataFile(const Job& job, std::string_view name, ImageHeader& header);

}  // namespace trocar::images::import
