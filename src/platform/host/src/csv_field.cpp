// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/csv_field.h"

#include "trocar/host/printable_output.h"

namespace trocar::host {

std::string FormatCsvField(std::string_view text) {
  std::string field = PrintableText(text);
  // spreadsheets look behind spaces and line ends, too
  const std::size_t first = field.find_first_not_of(" \t\n");
  const bool begins_with_tab = !field.empty() && field[0] == '\t';
  if (begins_with_tab ||
      (first != std::string::npos && std::string_view("=+-@").find(field[first]) != std::string_view::npos))
    field.insert(0, 1, '\'');
  if (field.find_first_of(",\"\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace trocar::host
