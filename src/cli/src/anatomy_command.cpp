// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "command.h"
#include "console.h"
#include "trocar/anatomy/build_patient.h"

namespace trocar::cli {
namespace {

struct BuildArguments {
  std::string control_points, images, output, reference, overlays;
  bool without_overlays = false;
};

core::Status Build(const BuildArguments& arguments) {
  anatomy::BuildOptions options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
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

}  // namespace

void AddAnatomyCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* anatomy = app.add_subcommand("anatomy", "From cross-sections to a patient");
  anatomy->require_subcommand(1);
  CLI::App* build =
      anatomy->add_subcommand("build", "Build a patient from control points placed on photographs");
  auto arguments = std::make_shared<BuildArguments>();
  build->add_option("control_points", arguments->control_points, "Control points (JSON)")
      ->required()
      ->type_name("FILE");
  build->add_option("--images", arguments->images, "Folder of the slices that the control points name")
      ->required()
      ->type_name("DIR");
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
}

}  // namespace trocar::cli
