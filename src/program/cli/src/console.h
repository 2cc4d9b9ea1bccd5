// SPDX-License-Identifier: Apache-2.0
/// \file console.h  Output of the commands for people: texts, numbers, tables and progress.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "trocar/host/console.h"
#include "trocar/host/json_text.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/progress_bar.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"

namespace trocar::cli {

/// A key as a person reads it: "cystic duct" of "cystic_duct", in the chosen language.
inline std::string ShownName(std::string_view key) {
  std::string name(key);
  std::replace(name.begin(), name.end(), '_', ' ');
  return host::Translate(name);
}

/// For programs. What is printed so is JSON, whatever bytes its texts hold.
template <class Json>
void PrintJson(const Json& json) {
  host::PrintJsonText(host::FormatJson(json, 2));
}

}  // namespace trocar::cli
