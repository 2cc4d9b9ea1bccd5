// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/contours/contour_rehearsal.h"

namespace trocar::cli {
namespace {

struct RehearseArguments {
  contours::RehearsalOptions options;
  std::string control_points, images, reference, overlays;
  std::vector<int> points = {8, 12};
  bool is_json = false;
};

base::Status Rehearse(const RehearseArguments& arguments) {
  contours::RehearsalOptions options = arguments.options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  options.reference = arguments.reference;
  options.clicks.points = {arguments.points.front(), arguments.points.back()};
  if (!arguments.overlays.empty()) options.overlays = arguments.overlays;
  host::ProgressBar bar("rehearsing", 1.0);
  const auto organs = contours::RehearseContours(options, bar.Follow());
  bar.Finish();
  if (!organs) return organs.error();
  if (arguments.is_json) {
    host::PrintLines(contours::FormatJson(*organs));
  } else {
    host::PrintTable(contours::Tabulate(*organs));
  }
  return {};
}

}  // namespace

void AddAnatomyRehearseCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "rehearse", "Simulate a user who clicks contours, and measure what the chain makes of the clicks");
  auto arguments = std::make_shared<RehearseArguments>();
  auto& clicks = arguments->options.clicks;
  command->add_option("--images", arguments->images, "Folder of slices")->required()->type_name("DIR");
  command
      ->add_option("--reference", arguments->reference, "Label map (NIfTI, NRRD) whose outlines are clicked")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--control-points", arguments->control_points,
                   "Control points (JSON) of the series: sizes, organs, labels; its points are not used")
      ->required()
      ->type_name("FILE");
  command->add_option("--organ", arguments->options.organ, "Only this organ")->type_name("NAME");
  command->add_option("--every", clicks.every, "Slices from one contoured slice to the next")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--noise-mm", clicks.noise_mm, "How far each click misses, in a random direction")
      ->type_name("MM")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  command->add_option("--points", arguments->points, "Fewest and most points on an outline")
      ->expected(1, 2)
      ->type_name("MIN MAX")
      ->check(CLI::Range(3, 1000))
      ->capture_default_str();
  command->add_option("--reach-mm", clicks.reach_mm, "How far the edge adaption may move a point")
      ->type_name("MM")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  command
      ->add_option("--skipped-mm", clicks.skipped_mm,
                   "How far the edges of skipped slices may move the contours interpolated there; 0: their "
                   "pictures are not looked at")
      ->type_name("MM")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Seed of the first run")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--runs", arguments->options.runs, "Simulated users, with seeds counting on")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--overlays", arguments->overlays, "Folder for pictures of the first run")
      ->type_name("DIR");
  AddJsonFlag(*command, arguments->is_json, "Every run as JSON");
  command->footer(
      "Point error: mean distance to the reference's outline. Dice: of the finished mesh against the "
      "reference.\n"
      "Example: trocar anatomy rehearse --images SLICES --reference LABELS.nii.gz \\\n"
      "           --control-points assets/patients/visible-human-male/control_points.json");
  command->callback([arguments, &outcome] { outcome.status = Rehearse(*arguments); });
}

}  // namespace trocar::cli
