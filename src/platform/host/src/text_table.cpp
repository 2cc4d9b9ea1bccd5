// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/text_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "trocar/host/printable_output.h"

namespace trocar::host {
namespace {

/// Characters, not bytes: continuation bytes of UTF-8 take no room.
std::size_t CountColumns(const std::string& cell) {
  return static_cast<std::size_t>(std::count_if(
      cell.begin(), cell.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string FormatNumber(double value, int digits) {
  if (!std::isfinite(value)) return "not a number";
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  if (std::string(text).find('e') != std::string::npos && std::fabs(value) >= 1 && std::fabs(value) < 1e15) {
    std::snprintf(text, sizeof text, "%.0f", value);
  }
  return text;
}

bool IsNumberText(std::string text) {
  if (text.empty()) return false;
  std::replace(text.begin(), text.end(), ',', '.');
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size();
}

std::string FormatTable(const std::vector<std::vector<std::string>>& given) {
  // a cell that somebody chose must not forge a line of its own
  std::vector<std::vector<std::string>> rows = given;
  for (std::vector<std::string>& row : rows) {
    for (std::string& cell : row) cell = PrintableLine(cell);
  }
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], CountColumns(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - CountColumns(row[i]), ' ');
      if (i > 0) line += "  ";
      line += IsNumberText(row[i]) ? padding + row[i] : row[i] + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string WrapText(const std::string& text, std::size_t width, const std::string& indent) {
  // a line end of somebody else's text would begin a line with what follows it
  std::istringstream words(PrintableLine(text));
  std::string wrapped, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent.size() + CountColumns(line) + 1 + CountColumns(word) > width) {
      wrapped += indent + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? wrapped : wrapped + indent + line + "\n";
}

}  // namespace trocar::host
