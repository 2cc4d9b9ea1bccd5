// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/contours/label_edges.h"

namespace trocar::cli {

using host::ShownFixed;

namespace {

struct LabelEdgesArguments {
  contours::LabelEdgeOptions options;
  std::string control_points, images, reference;
  bool is_json = false;
};

base::Status MeasureEdges(const LabelEdgesArguments& arguments) {
  contours::LabelEdgeOptions options = arguments.options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  options.reference = arguments.reference;
  host::ProgressBar bar("measuring", 1.0);
  const auto edges = contours::MeasureLabelEdges(options, bar.Follow());
  bar.Finish();
  if (!edges) return edges.error();
  if (arguments.is_json) {
    host::PrintLines(contours::FormatJson(*edges));
    return {};
  }
  host::PrintTable(contours::Tabulate(*edges));
  host::Say("\nShifted by {1} mm along columns, {2} mm along rows, {3} mm along slices.\n",
            ShownFixed(edges->shift_mm[0], 2, true), ShownFixed(edges->shift_mm[1], 2, true),
            ShownFixed(edges->shift_mm[2], 2, true));
  return {};
}

}  // namespace

void AddAnatomyLabelEdgesCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "label-edges", "Measure how far a label map's borders lie from the edges that the pictures show");
  auto arguments = std::make_shared<LabelEdgesArguments>();
  auto& options = arguments->options;
  command->add_option("--images", arguments->images, "Folder of slices")->required()->type_name("DIR");
  command->add_option("--reference", arguments->reference, "Label map (NIfTI, NRRD)")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--control-points", arguments->control_points,
                   "Control points (JSON) of the series: sizes, organs, labels, and contours to compare with")
      ->required()
      ->type_name("FILE");
  command->add_option("--every", options.every, "Slices from one measured slice to the next")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--reach-mm", options.reach_mm, "How far from the label an edge is looked for")
      ->type_name("MM")
      ->check(CLI::Range(1.0, 30.0))
      ->capture_default_str();
  command->add_option("--most-slices", options.most_slices, "The labels are shifted by up to so many slices")
      ->type_name("N")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  AddJsonFlag(*command, arguments->is_json, "The table as JSON");
  command->footer(
      "Tells whether a label map can judge an edge follower at all, and whether it lies beside the pictures\n"
      "as a whole. Signed: positive where the edge lies outside the label.\n"
      "Example: trocar anatomy label-edges --images SLICES --reference LABELS.nii.gz \\\n"
      "           --control-points assets/patients/visible-human-male/control_points.json");
  command->callback([arguments, &outcome] { outcome.status = MeasureEdges(*arguments); });
}

}  // namespace trocar::cli
