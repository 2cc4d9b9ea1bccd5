// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "image_options.h"
#include "start_window.h"

namespace trocar::cli {
namespace {

struct ContoursArguments {
  std::string images, points, reference, axes, pattern, script;
  std::optional<double> pixel_mm, slice_mm;  // none: the files say it
  int series = 0;                            // 0: there is one
};

base::Status Start(const ContoursArguments& arguments) {
  std::vector<std::string> words = {"--contours", arguments.images};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--points", arguments.points);
  add("--reference", arguments.reference);
  add("--axes", arguments.axes);
  add("--pattern", arguments.pattern);
  add("--script", arguments.script);
  if (arguments.pixel_mm) add("--pixel-mm", std::to_string(*arguments.pixel_mm));
  if (arguments.slice_mm) add("--slice-mm", std::to_string(*arguments.slice_mm));
  if (arguments.series > 0) add("--series", std::to_string(arguments.series));
  return StartWindow(words);
}

}  // namespace

void AddAnatomyContoursCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command =
      anatomy.add_subcommand("contours", "Open the contour window: draw organs on cross-sections");
  auto arguments = std::make_shared<ContoursArguments>();
  command
      ->add_option(
          "images", arguments->images,
          "Cross-sections: folder of pictures, DICOM series or volume, as trocar anatomy images reads")
      ->required()
      ->type_name("PATH");
  command
      ->add_option(
          "--points", arguments->points,
          "File of contours (control points) to go on with; a new one is begun where it does not exist")
      ->type_name("FILE");
  command
      ->add_option("--reference", arguments->reference, "Label map (NIfTI, NRRD) to show beside the contours")
      ->type_name("LABELS");
  AddSpacingOptions(*command, arguments->pixel_mm, arguments->slice_mm);
  AddPatternOption(*command, arguments->pattern);
  AddSeriesOption(*command, arguments->series);
  command
      ->add_option(
          "--axes", arguments->axes,
          "Where columns, rows and slice numbers grow to in the patient, where the files do not say it")
      ->type_name("DIR,DIR,DIR");
  command
      ->add_option("--script", arguments->script,
                   "Commands to begin with, one a line; trocar-window --help lists them")
      ->type_name("FILE");
  command->footer(
      "Work that was not saved is found again after a crash. Keys are shown in the window: press F1.\n"
      "Examples: trocar anatomy contours SLICES --points "
      "assets/patients/visible-human-male/control_points.json\n"
      "          trocar anatomy contours CT-FOLDER --points mine.json\n"
      "          trocar anatomy contours PHOTOS --pixel-mm 0.33 --slice-mm 1 --axes left,posterior,inferior");
  command->callback([arguments, &outcome] { outcome.status = Start(*arguments); });
}

}  // namespace trocar::cli
