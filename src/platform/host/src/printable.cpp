// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/printable.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "letter.h"

namespace trocar::host {

Letter DecodeLetter(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : byte(0) >= 0xC2 ? 2 : 0;
  if (length == 0 || byte(0) > 0xF4 || text.size() < length) return {};
  std::uint32_t code = byte(0) & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < kLeast[length] || code > 0x10FFFF || is_surrogate) return {};
  return {code, length};
}

bool IsHarmful(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code <= 0x9F) ||                          // control
         code == 0x061C || code == 0x200E || code == 0x200F ||                     // direction marks
         (code >= 0x2028 && code <= 0x202E) ||                                     // line ends, embedding
         (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF || code >= 0xE0000;  // isolates, tags
}

std::string Printable(std::string_view text, std::size_t most_characters) {
  most_characters = std::max<std::size_t>(most_characters, 16);
  std::vector<std::string> letters;
  while (!text.empty()) {
    const Letter letter = DecodeLetter(text);
    char escaped[16];
    if (letter.bytes == 0) {
      std::snprintf(escaped, sizeof(escaped), "\\x%02X", static_cast<unsigned>(text[0]) & 0xFFu);
      letters.emplace_back(escaped);
    } else if (IsHarmful(letter.code)) {
      std::snprintf(escaped, sizeof(escaped), letter.code < 0x80 ? "\\x%02X" : "\\u{%04X}",
                    static_cast<unsigned>(letter.code));
      letters.emplace_back(escaped);
    } else {
      letters.emplace_back(text.substr(0, letter.bytes));
    }
    text.remove_prefix(std::max<std::size_t>(letter.bytes, 1));
  }
  std::string result;
  const bool is_long = letters.size() > most_characters;
  const std::size_t kept = is_long ? (most_characters - 3) / 2 : letters.size();
  for (std::size_t i = 0; i < kept; ++i) result += letters[i];
  if (is_long) {
    result += "...";
    for (std::size_t i = letters.size() - kept; i < letters.size(); ++i) result += letters[i];
  }
  return result;
}

}  // namespace trocar::host
