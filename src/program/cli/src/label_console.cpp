// SPDX-License-Identifier: Apache-2.0
#include "label_console.h"

#include <string>
#include <utility>

#include "console.h"
#include "trocar/roles/roles.h"

namespace trocar::cli {

using host::Say;
using host::TranslateComposed;

void PrintLabels(const std::vector<patient::SourceLabel>& labels) {
  // in the order of the first of each
  std::vector<std::pair<std::string, std::string>> others;
  for (const patient::SourceLabel& one : labels) {
    const std::string meaning = TranslateComposed(roles::SpokenName(one.meaning)),
                      label = std::to_string(one.label);
    if (roles::FindRole<roles::OrganRole>(one.meaning)) {
      Say("Label {1} was taken for the {2}: {3}.\n", label, meaning, TranslateComposed(one.reason));
      if (!one.doubt.empty()) Say("  Against it: {1}.\n", TranslateComposed(one.doubt));
      continue;
    }
    const std::string shown = meaning + " " + label;
    if (others.empty() || others.back().first != one.reason) {
      others.emplace_back(one.reason, shown);
    } else {
      others.back().second += ", " + shown;
    }
  }
  for (const auto& [reason, names] : others)
    Say("Neighbours: {1}. Why: {2}.\n", names, TranslateComposed(reason));
  if (!labels.empty()) host::PrintLine();
}

}  // namespace trocar::cli
