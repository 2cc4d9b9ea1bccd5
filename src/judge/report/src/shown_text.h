// SPDX-License-Identifier: Apache-2.0
/// \file shown_text.h  Texts that strangers chose, made fit for a page.
#pragma once

#include <string>
#include <string_view>

#include "trocar/host/markup.h"
#include "trocar/host/printable.h"

namespace trocar::report {

inline constexpr std::size_t kMostLetters = 2000;

/// Without control characters, marks of direction and broken bytes, which are written out.
inline std::string Shown(std::string_view text) {
  return host::Printable(text, kMostLetters);
}

/// Shown text, escaped for use between tags and in quoted attributes.
inline std::string EscapeShown(std::string_view text) {
  return host::EscapeMarkup(Shown(text));
}

}  // namespace trocar::report
