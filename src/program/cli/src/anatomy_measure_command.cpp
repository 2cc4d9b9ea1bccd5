// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/anatomy/shape_measures.h"
#include "trocar/files/patient_file.h"

namespace trocar::cli {

using host::ShownNumber;

namespace {

using anatomy::ShapeMeasure;
using nlohmann::ordered_json;

struct Measured {
  std::string folder;
  std::vector<ShapeMeasure> measures;
};

const anatomy::ShapeRange* FindRange(std::string_view measure) {
  for (const anatomy::ShapeRange& range : anatomy::LiteratureRanges())
    if (range.measure == measure) return &range;
  return nullptr;
}

ordered_json MakeMeasuresJson(const std::vector<Measured>& all) {
  ordered_json json = {{"patients", ordered_json::array()}, {"literature", ordered_json::array()}};
  for (const Measured& one : all) {
    ordered_json measures = ordered_json::array();
    for (const ShapeMeasure& measure : one.measures) {
      measures.push_back({{"name", measure.name},
                          {"value", measure.value},
                          {"unit", measure.unit},
                          {"about", measure.about},
                          {"seen", measure.is_seen}});
    }
    json["patients"].push_back({{"patient", one.folder}, {"measures", measures}});
  }
  for (const anatomy::ShapeRange& range : anatomy::LiteratureRanges()) {
    json["literature"].push_back(
        {{"name", range.measure}, {"low", range.low}, {"high", range.high}, {"source", range.source}});
  }
  return json;
}

std::string FormatCell(const Measured& one, std::string_view name) {
  for (const ShapeMeasure& measure : one.measures) {
    if (measure.name == name) return ShownNumber(measure.value, 3) + (measure.is_seen ? "" : " *");
  }
  return "-";
}

void PrintMeasures(const std::vector<Measured>& all) {
  std::vector<std::vector<std::string>> rows = {{"measure", "unit"}};
  for (const Measured& one : all) {
    const std::filesystem::path folder = one.folder;
    rows.front().push_back((folder.has_filename() ? folder : folder.parent_path()).filename().string());
  }
  rows.front().insert(rows.front().end(), {host::Mark("literature"), host::Mark("how")});
  for (const ShapeMeasure& measure : all.front().measures) {
    rows.push_back({std::string(measure.name), std::string(measure.unit)});
    for (const Measured& one : all) rows.back().push_back(FormatCell(one, measure.name));
    const anatomy::ShapeRange* range = FindRange(measure.name);
    rows.back().push_back(range == nullptr ? ""
                                           : host::TranslateWith("{1} to {2}", {ShownNumber(range->low),
                                                                                ShownNumber(range->high)}));
    rows.back().push_back(host::Translate(measure.about));
  }
  host::PrintTable(rows);
  host::Say("\n*: hangs on a duct that was placed by landmarks, not seen.\n");
}

base::Status MeasurePatients(const std::vector<std::string>& folders, bool is_json) {
  std::vector<Measured> all;
  for (const std::string& folder : folders) {
    const auto patient = files::ReadPatient(folder);
    if (!patient) return patient.error();
    auto measures = anatomy::MeasureShapes(*patient);
    if (!measures) return base::Error{measures.error().code, folder + ": " + measures.error().message};
    all.push_back({folder, std::move(*measures)});
  }
  if (is_json) {
    PrintJson(MakeMeasuresJson(all));
  } else {
    PrintMeasures(all);
  }
  return {};
}

}  // namespace

void AddAnatomyMeasureCommand(CLI::App& anatomy, Outcome& outcome) {
  struct Arguments {
    std::vector<std::string> patients;
    bool is_json = false;
  };
  CLI::App* measure = anatomy.add_subcommand("measure", "Measure the shapes of liver and gallbladder");
  auto arguments = std::make_shared<Arguments>();
  measure->add_option("patients", arguments->patients, "Patient folders, one column each")
      ->required()
      ->type_name("PATIENT...");
  AddJsonFlag(*measure, arguments->is_json,
              "Machine-readable: {\"patients\": [{patient, measures: [{name, value, unit, about, "
              "seen}]}],\n\"literature\": [{name, low, high, source}]}");
  measure->footer(
      "docs/shapes.md compares generated patients with a real one and with the literature.\n"
      "Example: trocar anatomy measure assets/patients/visible-human-male/patient out/seven");
  measure->callback(
      [arguments, &outcome] { outcome.status = MeasurePatients(arguments->patients, arguments->is_json); });
}

}  // namespace trocar::cli
