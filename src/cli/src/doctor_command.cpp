// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "trocar/doctor/doctor_checks.h"

namespace trocar::cli {
namespace {

using doctor::Finding;
using doctor::Health;

void PrintJson(const std::vector<Finding>& findings) {
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
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void PrintForPerson(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    std::printf("%-10s %-8s %s\n", finding.name.c_str(),
                std::string(doctor::HealthName(finding.health)).c_str(), finding.found.c_str());
    std::printf("%19s %s\n", "", finding.meaning.c_str());
    if (!finding.remedy.empty()) std::printf("%19s to mend: %s\n", "", finding.remedy.c_str());
  }
  const auto missing = std::count_if(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.health == Health::kMissing;
  });
  std::printf("\n%s\n",
              missing == 0 ? "Trocar runs here." : "Something is missing: mend what is named above.");
}

}  // namespace

void AddDoctorCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Check graphics, GPU, display, real-time permission, devices, sound and data; say how to mend them");
  auto is_json = std::make_shared<bool>(false);
  command->add_flag("--json", *is_json,
                    "Machine-readable: {\"checks\": [{name, state, found, meaning, remedy}]}");
  command->footer(
      "A state is \"good\", \"limited\" (Trocar runs, and something is slower or absent) or \"missing\" (a "
      "command does\n"
      "not work). Exit status 1 if anything is missing.");
  command->callback([is_json, &outcome] {
    const std::vector<Finding> findings = doctor::CheckAll();
    *is_json ? PrintJson(findings) : PrintForPerson(findings);
    outcome.has_finding = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
      return finding.health == Health::kMissing;
    });
  });
}

}  // namespace trocar::cli
