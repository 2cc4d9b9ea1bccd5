// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/markup.h"

#include "trocar/host/printable_output.h"

namespace trocar::host {

std::string EscapeMarkup(std::string_view text) {
  std::string escaped;
  for (const char c : PrintableText(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace trocar::host
