// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "label_console.h"
#include "trocar/anatomy/patient_lint.h"

namespace trocar::cli {

using host::PrintLine;

namespace {

void PrintFindingsJson(const anatomy::LintReport& report) {
  nlohmann::ordered_json json;
  json["meshes"] = nlohmann::ordered_json::array();
  for (const anatomy::MeshSummary& mesh : report.meshes) {
    json["meshes"].push_back({{"name", mesh.name},
                              {"triangles", mesh.triangles},
                              {"closed", mesh.closed},
                              {"manifold", mesh.manifold},
                              {"self_intersections", mesh.self_intersections},
                              {"volume_ml", mesh.volume_ml}});
  }
  if (!report.labels.empty()) json["labels"] = nlohmann::ordered_json::array();
  for (const patient::SourceLabel& label : report.labels) {
    json["labels"].push_back({{"label", label.label}, {"taken_as", label.meaning}, {"reason", label.reason}});
    if (!label.doubt.empty()) json["labels"].back()["doubt"] = label.doubt;
  }
  json["findings"] = nlohmann::ordered_json::array();
  for (const anatomy::LintFinding& finding : report.findings) {
    json["findings"].push_back({{"code", finding.code}, {"where", finding.where}, {"text", finding.text}});
  }
  // names come from a file and may hold any bytes
  PrintJson(json);
}

void PrintFindings(const anatomy::LintReport& report) {
  std::vector<std::vector<std::string>> rows = {
      {"organ", "triangles", "closed", "manifold", "self-intersections", "volume [mL]"}};
  for (const anatomy::MeshSummary& mesh : report.meshes) {
    rows.push_back({host::TranslateComposed(mesh.name), std::to_string(mesh.triangles),
                    host::Translate(mesh.closed ? "yes" : "no"),
                    host::Translate(mesh.manifold ? "yes" : "no"), std::to_string(mesh.self_intersections),
                    host::ShownNumber(mesh.volume_ml)});
  }
  host::PrintTable(rows);
  PrintLine();
  PrintLabels(report.labels);
  for (const anatomy::LintFinding& finding : report.findings) {
    PrintLine(finding.code + "  " + finding.where);
    PrintLine("    " + host::TranslateComposed(finding.text));
  }
  if (report.findings.empty()) {
    host::Say("No findings.\n");
  } else {
    PrintLine();
    host::Print(host::TranslateCount("{1} finding", "{1} findings", report.findings.size()));
    host::Say("; docs/patient-check.md explains each code.\n");
  }
}

}  // namespace

void AddAnatomyCheckCommand(CLI::App& anatomy, Outcome& outcome) {
  struct Arguments {
    std::string patient;
    bool is_json = false;
  };
  CLI::App* check = anatomy.add_subcommand("check", "Say what is wrong with a patient, and where");
  auto arguments = std::make_shared<Arguments>();
  check->add_option("patient", arguments->patient, "Patient folder")->required()->type_name("PATIENT");
  AddJsonFlag(
      *check, arguments->is_json,
      "Machine-readable: {\"meshes\": [{name, triangles, closed, manifold, self_intersections, "
      "volume_ml}],\n\"labels\": [{label, taken_as, reason, doubt}], \"findings\": [{code, where, text}]}");
  check->footer(
      "Exit status 0 without findings, 1 with findings. Places are in the files' frame: LPS, millimetres.\n"
      "Example: trocar anatomy check assets/patients/visible-human-male/patient --json");
  check->callback([arguments, &outcome] {
    const auto report = anatomy::LintPatientFolder(arguments->patient);
    if (!report) {
      outcome.status = report.error();
      return;
    }
    arguments->is_json ? PrintFindingsJson(*report) : PrintFindings(*report);
    outcome.has_finding = !report->findings.empty();
  });
}

}  // namespace trocar::cli
