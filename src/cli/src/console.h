// SPDX-License-Identifier: Apache-2.0
/// \file console.h  What the commands print with, for people: texts, numbers, tables and progress.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "trocar/core/console.h"
#include "trocar/core/json_text.h"
#include "trocar/core/printable_output.h"
#include "trocar/core/progress_bar.h"
#include "trocar/core/text_table.h"
#include "trocar/core/translate.h"

namespace trocar::cli {

/// A key as a person reads it: "cystic duct" of "cystic_duct", in the chosen language.
inline std::string ShownName(std::string_view key) {
  std::string name(key);
  std::replace(name.begin(), name.end(), '_', ' ');
  return core::Translate(name);
}

/// For programs. What is printed so is JSON, whatever bytes its texts hold.
template <class Json>
void PrintJson(const Json& json) {
  core::PrintJsonText(core::FormatJson(json, 2));
}

using core::FormatFields;
using core::FormatShownTable;
using core::Mark;
using core::Print;
using core::PrintErrorLine;
using core::PrintLine;
using core::PrintLines;
using core::PrintTable;
using core::ProgressBar;
using core::Say;
using core::ShownFixed;
using core::ShownNumber;
using core::Translate;
using core::TranslateComposed;
using core::TranslateCount;
using core::TranslateWith;
using core::WrapText;

}  // namespace trocar::cli
