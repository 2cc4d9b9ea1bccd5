// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <vector>

#include "anatomy_settings.h"
#include "command.h"
#include "console.h"
#include "image_options.h"
#include "label_console.h"
#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/patient_from_labels.h"

namespace trocar::cli {

using host::PrintLine;
using host::Say;
using host::ShownNumber;
using host::Translate;

namespace {

struct BuildArguments {
  std::string control_points, images, window, output, reference, overlays;
  bool without_overlays = false, is_bare = false;
  double skipped_px = -1;
  int series = 0;  // 0: there is one
};

base::Status Build(const BuildArguments& arguments) {
  anatomy::BuildOptions options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  if (!arguments.window.empty()) {
    const auto window = ParseWindow(arguments.window);
    if (!window) return window.error();
    options.window = *window;
  }
  options.dicom_series = arguments.series;
  options.output = arguments.output;
  options.has_surroundings = !arguments.is_bare;
  if (arguments.skipped_px >= 0) options.skipped_shift_px = arguments.skipped_px;
  if (!arguments.reference.empty()) options.reference = arguments.reference;
  if (!arguments.without_overlays) {
    options.overlays = arguments.overlays.empty() ? arguments.output + "-overlays" : arguments.overlays;
  }
  host::ProgressBar bar("building", 1.0);
  const base::Result<anatomy::BuildReport> report = anatomy::BuildPatient(options, bar.Follow());
  bar.Finish();
  if (!report) return report.error();
  host::PrintLines(anatomy::FormatReport(*report) + "\n" + anatomy::FormatSurroundings(*report));
  Say("\nWrote {1}\n", arguments.output);
  if (report->overlays > 0) {
    Say("Wrote {1} pictures to check by eye into {2}\n", report->overlays, options.overlays->c_str());
  }
  return {};
}

base::Status BuildFromLabels(const anatomy::LabelOptions& options) {
  host::ProgressBar bar("building", 1.0);
  const base::Result<anatomy::BuildReport> report = anatomy::BuildPatientFromLabels(options, bar.Follow());
  bar.Finish();
  if (!report) return report.error();
  std::vector<std::vector<std::string>> rows = {{"organ", "slices", "triangles", "closed", "manifold",
                                                 "genus", "cuts", "min angle [deg]", "volume [mL]",
                                                 "volume change [%]", "distance [mm]", "mean [mm]"}};
  for (const contours::OrganReport& organ : report->organs) {
    rows.push_back({Translate(organ.name), std::to_string(organ.slices), std::to_string(organ.triangles),
                    Translate(organ.closed ? "yes" : "NO"), Translate(organ.manifold ? "yes" : "NO"),
                    std::to_string(organ.genus), std::to_string(organ.self_intersections),
                    ShownNumber(organ.min_angle_deg, 3), ShownNumber(organ.volume_ml),
                    ShownNumber(100 * organ.volume_change, 2), ShownNumber(organ.hausdorff_mm, 3),
                    ShownNumber(organ.mean_distance_mm, 3)});
  }
  host::PrintTable(rows);
  Say("Distance: of mesh and label surface from each other, the largest both ways, and the mesh's mean.\n");
  host::PrintLines("\n" + anatomy::FormatSurroundings(*report));
  PrintLine();
  PrintLabels(report->patient.labels);
  for (const std::string& note : report->notes) PrintLine(host::TranslateComposed(note));
  PrintLine();
  PrintLine(host::TranslateComposed(report->patient.provenance) + ".");
  Say("Wrote {1}\n", options.output);
  return {};
}

void AddFromLabelsCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command =
      anatomy.add_subcommand("from-labels", "Build a patient from a label map of liver and gallbladder");
  auto options = std::make_shared<anatomy::LabelOptions>();
  command
      ->add_option(
          "labels", options->labels,
          "Label map: NIfTI (.nii, .nii.gz), NRRD (.nrrd) or MetaImage (.mha); or a folder with masks named "
          "liver and gallbladder")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "Patient folder to write")
      ->required()
      ->type_name("PATIENT");
  command->add_option("--liver", options->liver, "Label of the liver, if it cannot be found by itself")
      ->check(CLI::Range(1, images::kLargestLabel))
      ->type_name("LABEL");
  command->add_option("--gallbladder", options->gallbladder, "Label of the gallbladder, likewise")
      ->check(CLI::Range(1, images::kLargestLabel))
      ->type_name("LABEL");
  command
      ->add_option("--names", options->names,
                   "Table that says which label is what: JSON ({\"liver\": 5}, nnU-Net's dataset.json), CSV "
                   "or TSV with a header, a colour "
                   "table of 3D Slicer or a label description of ITK-SNAP")
      ->type_name("FILE");
  command
      ->add_option("--images", options->images,
                   "The CT that the labels were drawn on: their densities are compared with what they are "
                   "taken for")
      ->type_name("PATH");
  AddSeriesOption(*command, options->opening.series)->needs("--images");
  command->add_flag(
      "--mirrored", options->is_mirrored,
      "Left and right of the map are swapped, or it is situs inversus: take it the other way round");
  command->add_flag("--largest-part", options->takes_largest_part,
                    "Take the largest part of an organ that is in several, whatever is lost");
  command->footer(
      "Labels are found by the names in the file or the table, in many languages; without names by their "
      "numbers, where\n"
      "all of them fit one known scheme (TotalSegmentator, AbdomenAtlas, BTCV, AMOS, ...; docs/patients.md) "
      "and sizes,\n"
      "places and densities agree. What is not certain is asked for. Ducts and arteries are placed by "
      "landmarks.\n"
      "Examples: trocar anatomy from-labels total.nii.gz -o out/patient\n"
      "          trocar anatomy from-labels segmentations -o out/patient\n"
      "          trocar anatomy from-labels mine.nrrd --liver 3 --gallbladder 4 -o out/patient");
  command->callback([options, &outcome] { outcome.status = BuildFromLabels(*options); });
}

}  // namespace

base::Result<std::vector<anatomy::ParameterSetting>> ParseSettings(const std::vector<std::string>& texts) {
  std::vector<anatomy::ParameterSetting> settings;
  for (const std::string& text : texts) {
    const auto at = text.find('=');
    if (at == std::string::npos || at == 0) {
      return base::Error{base::ErrorCode::kUsage, "--set: \"" + text + "\" is not like hydrops=0.5"};
    }
    settings.emplace_back(text.substr(0, at), text.substr(at + 1));
  }
  return settings;
}

void AddAnatomyCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* anatomy = AddListed(app, "anatomy");
  anatomy->require_subcommand(1);
  CLI::App* build =
      anatomy->add_subcommand("build", "Build a patient from control points placed on cross-sections");
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
  AddSeriesOption(*build, arguments->series);
  build->add_option("-o,--output", arguments->output, "Patient folder to write")
      ->required()
      ->type_name("PATIENT");
  build
      ->add_option("--reference", arguments->reference,
                   "Label map (NIfTI, NRRD) that only judges the result: volume, Dice")
      ->type_name("FILE");
  build
      ->add_option("--skipped-px", arguments->skipped_px,
                   "How far the edges of slices that nobody contoured may move the contours in between "
                   "(default: what the control points say); 0: their pictures are not looked at")
      ->check(CLI::Range(0.0, 30.0))
      ->type_name("PX");
  build
      ->add_option("--overlays", arguments->overlays,
                   "Folder for one picture a slice with the contours drawn in (default: PATIENT-overlays)")
      ->type_name("DIR");
  build->add_flag("--no-overlays", arguments->without_overlays, "Write no pictures");
  build->add_flag("--bare", arguments->is_bare,
                  "Organs, ducts and arteries alone: no neighbours from the template, no ports of its own");
  build->footer(
      "Prints a table of the organs and writes a picture of each contoured slice to check by eye.\n"
      "Nothing is written when any step fails.\n"
      "Example: trocar anatomy build assets/patients/visible-human-male/control_points.json --images SLICES "
      "\\\n"
      "           -o out/patient");
  build->callback([arguments, &outcome] { outcome.status = Build(*arguments); });
  AddAnatomyCheckCommand(*anatomy, outcome);
  AddAnatomyCompleteCommand(*anatomy, outcome);
  AddAnatomyContoursCommand(*anatomy, outcome);
  AddAnatomyExportCommand(*anatomy, outcome);
  AddAnatomyGrowCommand(*anatomy, outcome);
  AddAnatomyRehearseCommand(*anatomy, outcome);
  AddAnatomyEditCommand(*anatomy, outcome);
  AddAnatomyLabelEdgesCommand(*anatomy, outcome);
  AddAnatomyMeasureCommand(*anatomy, outcome);
  AddAnatomyPhantomCommand(*anatomy, outcome);
  AddAnatomyViewCommand(*anatomy, outcome);
  AddAnatomyImagesCommand(*anatomy, outcome);
  AddAnatomyGenerateCommand(*anatomy, outcome);
  AddFromLabelsCommand(*anatomy, outcome);
}

}  // namespace trocar::cli
