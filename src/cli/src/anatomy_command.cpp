// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "command.h"
#include "console.h"
#include "image_options.h"
#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/anatomy/patient_parameters.h"

namespace trocar::cli {
namespace {

struct BuildArguments {
  std::string control_points, images, window, output, reference, overlays;
  bool without_overlays = false;
};

core::Status Build(const BuildArguments& arguments) {
  anatomy::BuildOptions options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  if (!arguments.window.empty()) {
    const auto window = ParseWindow(arguments.window);
    if (!window) return window.error();
    options.window = *window;
  }
  options.output = arguments.output;
  if (!arguments.reference.empty()) options.reference = arguments.reference;
  if (!arguments.without_overlays) {
    options.overlays = arguments.overlays.empty() ? arguments.output + "-overlays" : arguments.overlays;
  }
  ProgressBar bar("building", 1.0);
  const core::Result<anatomy::BuildReport> report =
      anatomy::BuildPatient(options, [&](std::string_view what, double fraction) {
        bar.SetLabel(what);
        bar.Show(fraction);
      });
  bar.Finish();
  if (!report) return report.error();
  std::fputs(anatomy::FormatReport(*report).c_str(), stdout);
  std::printf("\nWrote %s\n", arguments.output.c_str());
  if (report->overlays > 0) {
    std::printf("Wrote %zu pictures to check by eye into %s\n", report->overlays, options.overlays->c_str());
  }
  return {};
}

struct GenerateArguments {
  std::uint64_t seed = 0;
  std::string output;
  std::vector<std::string> settings;
  bool is_list = false;
};

std::string FormatValue(const std::variant<double, std::string>& value) {
  const double* number = std::get_if<double>(&value);
  return number != nullptr ? FormatNumber(*number) : std::get<std::string>(value);
}

/// What a parameter is drawn from, in words.
std::string FormatRule(const anatomy::ParameterRule& rule) {
  const auto number = [](double value) { return FormatNumber(value); };
  switch (rule.distribution) {
    case anatomy::Distribution::kNormal:
      return number(rule.centre) + " +- " + number(rule.spread) + ", " + number(rule.low) + " to " +
             number(rule.high);
    case anatomy::Distribution::kLognormal:
      return "median " + number(rule.centre) + ", log deviation " + number(rule.spread) + ", " +
             number(rule.low) + " to " + number(rule.high);
    case anatomy::Distribution::kChance:
      return "yes in " + number(100 * rule.centre) + " %";
    case anatomy::Distribution::kChoice: {
      double total = 0;
      for (const anatomy::Choice& choice : rule.choices) total += choice.weight;
      std::string text;
      for (const anatomy::Choice& choice : rule.choices) {
        text += (text.empty() ? "" : ", ") + std::string(choice.name) + " " +
                FormatNumber(100 * choice.weight / total, 3) + " %";
      }
      return text;
    }
    case anatomy::Distribution::kFixed:
      return number(rule.centre) + " unless set, " + number(rule.set_low) + " to " + number(rule.set_high);
  }
  return {};
}

void PrintRules() {
  std::vector<std::vector<std::string>> rows = {{"name", "unit", "drawn from", "what it is", "source"}};
  for (const anatomy::ParameterRule& rule : anatomy::ParameterRules()) {
    rows.push_back({std::string(rule.name), std::string(rule.unit), FormatRule(rule), std::string(rule.about),
                    std::string(rule.source)});
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
}

void PrintParameters(const anatomy::Patient& patient) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "unit", "source"}};
  for (const anatomy::Parameter& parameter : patient.parameters) {
    rows.push_back({parameter.name, FormatValue(parameter.value), parameter.unit, parameter.source});
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
}

core::Status Generate(const GenerateArguments& arguments) {
  if (arguments.is_list) {
    PrintRules();
    return {};
  }
  if (arguments.output.empty()) {
    return core::Error{core::ErrorCode::kUsage, "name the patient folder to write with -o PATIENT"};
  }
  const auto settings = ParseSettings(arguments.settings);
  if (!settings) return settings.error();
  const core::Result<anatomy::Patient> patient = anatomy::GeneratePatient(arguments.seed, *settings);
  if (!patient) return patient.error();
  if (auto status = anatomy::WritePatient(arguments.output, *patient); !status) return status;
  PrintParameters(*patient);
  std::printf("\nWrote %s\n", arguments.output.c_str());
  return {};
}

void AddGenerateCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* generate = anatomy.add_subcommand("generate", "Make a plausible patient without any images");
  auto arguments = std::make_shared<GenerateArguments>();
  generate->add_option("--seed", arguments->seed, "The same seed and settings give the same patient")
      ->type_name("N")
      ->capture_default_str();
  generate->add_option("-o,--output", arguments->output, "Patient folder to write")->type_name("PATIENT");
  generate
      ->add_option("--set", arguments->settings,
                   "Value in place of a drawn one, name=value; may be given several times")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  generate->add_flag("--list", arguments->is_list, "Print every parameter with its distribution and source");
  generate->footer(
      "Every value that was drawn, set or measured is listed and kept in the patient's file.\n"
      "Examples: trocar anatomy generate --seed 7 -o out/seven\n"
      "          trocar anatomy generate --seed 7 --set moynihan_hump=yes --set hydrops=1 -o out/seven\n"
      "          trocar demo --patient out/seven -o out/demo");
  generate->callback([arguments, &outcome] { outcome.status = Generate(*arguments); });
}

core::Status BuildFromLabels(const anatomy::LabelOptions& options) {
  ProgressBar bar("building", 1.0);
  const core::Result<anatomy::BuildReport> report =
      anatomy::BuildPatientFromLabels(options, [&](std::string_view what, double fraction) {
        bar.SetLabel(what);
        bar.Show(fraction);
      });
  bar.Finish();
  if (!report) return report.error();
  std::vector<std::vector<std::string>> rows = {
      {"organ", "slices", "triangles", "closed", "manifold", "genus", "cuts", "volume [mL]"}};
  for (const anatomy::OrganReport& organ : report->organs) {
    rows.push_back({organ.name, std::to_string(organ.slices), std::to_string(organ.triangles),
                    organ.closed ? "yes" : "NO", organ.manifold ? "yes" : "NO", std::to_string(organ.genus),
                    std::to_string(organ.self_intersections), FormatNumber(organ.volume_ml)});
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
  std::printf("\n%s.\nWrote %s\n", report->patient.provenance.c_str(), options.output.c_str());
  return {};
}

void AddFromLabelsCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command =
      anatomy.add_subcommand("from-labels", "Build a patient from a label map of liver and gallbladder");
  auto options = std::make_shared<anatomy::LabelOptions>();
  command
      ->add_option("labels", options->labels,
                   "Label map: NIfTI (.nii, .nii.gz), NRRD (.nrrd) or MetaImage (.mha)")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "Patient folder to write")
      ->required()
      ->type_name("PATIENT");
  command->add_option("--liver", options->liver, "Label of the liver, if it cannot be found by itself")
      ->check(CLI::Range(1, 255))
      ->type_name("LABEL");
  command->add_option("--gallbladder", options->gallbladder, "Label of the gallbladder, likewise")
      ->check(CLI::Range(1, 255))
      ->type_name("LABEL");
  command->footer(
      "Labels are found by the segment names of 3D Slicer, by TotalSegmentator's numbers (liver 5, "
      "gallbladder "
      "2),\nor are 1 and 2. Ducts and arteries are placed by landmarks.\n"
      "Examples: trocar anatomy from-labels total.nii.gz -o out/patient\n"
      "          trocar anatomy from-labels mine.nrrd --liver 3 --gallbladder 4 -o out/patient");
  command->callback([options, &outcome] { outcome.status = BuildFromLabels(*options); });
}

}  // namespace

core::Result<std::vector<anatomy::ParameterSetting>> ParseSettings(const std::vector<std::string>& texts) {
  std::vector<anatomy::ParameterSetting> settings;
  for (const std::string& text : texts) {
    const auto at = text.find('=');
    if (at == std::string::npos || at == 0) {
      return core::Error{core::ErrorCode::kUsage, "--set: \"" + text + "\" is not like hydrops=0.5"};
    }
    settings.emplace_back(text.substr(0, at), text.substr(at + 1));
  }
  return settings;
}

void AddAnatomyCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* anatomy = app.add_subcommand("anatomy", "A patient from cross-sections, or from none");
  anatomy->require_subcommand(1);
  CLI::App* build =
      anatomy->add_subcommand("build", "Build a patient from control points placed on photographs");
  auto arguments = std::make_shared<BuildArguments>();
  build->add_option("control_points", arguments->control_points, "Control points (JSON)")
      ->required()
      ->type_name("FILE");
  build
      ->add_option(
          "--images", arguments->images,
          "The series that the control points were placed on: folder or file, as trocar anatomy images "
          "reads it")
      ->required()
      ->type_name("PATH");
  build
      ->add_option(
          "--window", arguments->window,
          "Grey values to find edges in, as they were shown when the points were placed (default: the "
          "window that trocar anatomy images suggests)")
      ->type_name("CENTRE,WIDTH");
  build->add_option("-o,--output", arguments->output, "Patient folder to write")
      ->required()
      ->type_name("PATIENT");
  build
      ->add_option("--reference", arguments->reference,
                   "Label map (NIfTI) that only judges the result: volume, Dice")
      ->type_name("FILE");
  build
      ->add_option("--overlays", arguments->overlays,
                   "Folder for one picture a slice with the contours drawn in (default: PATIENT-overlays)")
      ->type_name("DIR");
  build->add_flag("--no-overlays", arguments->without_overlays, "Write no pictures");
  build->footer(
      "Prints a table of the organs and writes a picture of each contoured slice to check by eye.\n"
      "Nothing is written when any step fails.\n"
      "Example: trocar anatomy build assets/patients/visible-human-male/control_points.json --images SLICES "
      "\\\n"
      "           -o out/patient");
  build->callback([arguments, &outcome] { outcome.status = Build(*arguments); });
  AddAnatomyCheckCommand(*anatomy, outcome);
  AddAnatomyExportCommand(*anatomy, outcome);
  AddAnatomyPhantomCommand(*anatomy, outcome);
  AddAnatomyViewCommand(*anatomy, outcome);
  AddAnatomyImagesCommand(*anatomy, outcome);
  AddGenerateCommand(*anatomy, outcome);
  AddFromLabelsCommand(*anatomy, outcome);
}

}  // namespace trocar::cli
