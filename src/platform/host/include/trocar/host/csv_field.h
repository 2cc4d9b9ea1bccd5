// SPDX-License-Identifier: Apache-2.0
/// \file csv_field.h  Texts and names in a table for a spreadsheet.
#pragma once

#include <string>
#include <string_view>

namespace trocar::host {

/// A text as a field of RFC 4180, printable, and no formula: one that begins with = + - @ or a tab gets an apostrophe before it, by
/// which spreadsheets know a text. Not for numbers, which are written as they are.
std::string FormatCsvField(std::string_view text);

}  // namespace trocar::host
