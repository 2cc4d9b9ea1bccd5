// SPDX-License-Identifier: Apache-2.0
#include "measured_cases.h"

#include "trocar/host/json.h"

namespace trocar::bench {

base::Result<std::map<std::string, double>> ReadMeasuredCases(const std::string& text,
                                                              const std::string& source) {
  const auto document = host::JsonDocument::Parse(text, source);
  if (!document.ok()) return document.error();
  std::map<std::string, double> values;
  for (const host::JsonView& entry : document->Root().Array("cases"))
    values[entry.Text("name")] = entry.Number("value");
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return values;
}

}  // namespace trocar::bench
