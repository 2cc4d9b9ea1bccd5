// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/console.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "trocar/host/printable_output.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"

namespace trocar::host {

std::string ShownNumber(double value, int digits) {
  return Translate(LocalNumber(FormatNumber(value, digits)));
}

std::string ShownFixed(double value, int decimals, bool has_sign) {
  char text[64];
  std::snprintf(text, sizeof text, has_sign ? "%+.*f" : "%.*f", decimals, value);
  return LocalNumber(text);
}

void Print(std::string_view text) {
  PrintLines(PrintableLine(text));
}

void PrintLine(std::string_view text) {
  PrintLines(PrintableLine(text) + "\n");
}

void PrintErrorLine(std::string_view text) {
  std::fprintf(stderr, "%s\n", PrintableLine(text).c_str());
}

void PrintLines(std::string_view lines) {
  std::fwrite(lines.data(), 1, lines.size(), stdout);
}

void PrintJsonText(std::string_view json) {
  PrintLines(json);
  PrintLines("\n");
}

std::string FormatShownTable(std::vector<std::vector<std::string>> rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::string& cell : rows[i]) {
      if (i == 0)
        cell = Translate(cell);
      else if (IsNumberText(cell))
        cell = LocalNumber(cell);
    }
  }
  return FormatTable(rows);
}

void PrintTable(std::vector<std::vector<std::string>> rows) {
  PrintLines(FormatShownTable(std::move(rows)));
}

std::string FormatFields(std::vector<std::vector<std::string>> rows) {
  for (std::vector<std::string>& row : rows) row.front() = Translate(row.front());
  return FormatTable(rows);
}

std::string SaidText(std::string_view pattern, std::initializer_list<std::string> values) {
  constexpr const char* kSpace = " \n";
  const std::size_t begin = std::min(pattern.find_first_not_of(kSpace), pattern.size());
  const std::size_t end = std::max(pattern.find_last_not_of(kSpace) + 1, begin);
  // a value that somebody chose must not forge a line of its own
  std::vector<std::string> lines;
  for (const std::string& value : values) lines.push_back(PrintableLine(value));
  const std::vector<std::string_view> views(lines.begin(), lines.end());
  return std::string(pattern.substr(0, begin)) + TranslateWith(pattern.substr(begin, end - begin), views) +
         std::string(pattern.substr(end));
}

}  // namespace trocar::host
