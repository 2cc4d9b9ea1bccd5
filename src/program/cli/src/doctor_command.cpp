// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/doctor/doctor_checks.h"
#include "trocar/host/text_table.h"

namespace trocar::cli {

using host::TranslateComposed;

namespace {

using doctor::Finding;
using doctor::Health;

void PrintChecksJson(const std::vector<Finding>& findings) {
  nlohmann::ordered_json json;
  json["checks"] = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    json["checks"].push_back({{"name", finding.name},
                              {"state", doctor::HealthName(finding.health)},
                              {"found", finding.found},
                              {"meaning", finding.meaning},
                              {"remedy", finding.remedy}});
  }
  // a driver's text may hold any bytes
  PrintJson(json);
}

/// What was found may be an error: its code, then the message.
std::string ShownFound(const std::string& found) {
  const std::size_t space = found.find(' ');
  if (!found.starts_with("E-") || space == std::string::npos) return TranslateComposed(found);
  return found.substr(0, space + 1) + TranslateComposed(found.substr(space + 1));
}

void PrintChecks(const std::vector<Finding>& findings) {
  std::vector<std::vector<std::string>> rows;
  for (const Finding& finding : findings) {
    rows.push_back({finding.name, host::TranslateIn("health", doctor::HealthName(finding.health)),
                    ShownFound(finding.found)});
    rows.push_back({"", "", TranslateComposed(finding.meaning)});
    if (!finding.remedy.empty())
      rows.push_back({"", "", host::TranslateWith("to mend: {1}", {TranslateComposed(finding.remedy)})});
  }
  host::PrintLines(host::FormatTable(rows));
  const auto missing = std::count_if(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.health == Health::kMissing;
  });
  host::Say(missing == 0 ? "\nTrocar runs here.\n" : "\nSomething is missing: mend what is named above.\n");
}

}  // namespace

void AddDoctorCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "doctor");
  auto is_json = std::make_shared<bool>(false);
  AddJsonFlag(*command, *is_json, "Machine-readable: {\"checks\": [{name, state, found, meaning, remedy}]}");
  command->footer(
      "A state is \"good\", \"limited\" (Trocar runs, and something is slower or absent) or \"missing\" (a "
      "command does\n"
      "not work). Exit status 1 if anything is missing.");
  command->callback([is_json, &outcome] {
    const std::vector<Finding> findings = doctor::CheckAll();
    *is_json ? PrintChecksJson(findings) : PrintChecks(findings);
    outcome.has_finding = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
      return finding.health == Health::kMissing;
    });
  });
}

}  // namespace trocar::cli
