// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/contours/label_edges.h"

namespace trocar::cli {
namespace {

struct Arguments {
  contours::LabelEdgeOptions options;
  std::string control_points, images, reference;
  bool is_json = false;
};

void PrintForPerson(const contours::LabelEdges& edges) {
  std::vector<std::vector<std::string>> rows = {{"organ", "labels", "places", "edge seen",
                                                 "mean distance [mm]", "median", "signed mean", "within 1 mm",
                                                 "drawn contours [mm]"}};
  const auto add = [&](const std::vector<contours::LabelEdgeReport>& reports, const std::string& labels) {
    for (const auto& report : reports) {
      rows.push_back({Translate(report.name), labels, std::to_string(report.places),
                      ShownFixed(report.seen, 2), ShownFixed(report.mean_mm, 2),
                      ShownFixed(report.median_mm, 2), ShownFixed(report.signed_mean_mm, 2, true),
                      ShownFixed(report.within_1mm, 2), ShownFixed(report.drawn_mm, 2)});
    }
  };
  add(edges.as_given, Translate("as given"));
  add(edges.shifted, Translate("shifted"));
  PrintTable(rows);
  Say("\nShifted by {1} mm along columns, {2} mm along rows, {3} mm along slices.\n",
      ShownFixed(edges.shift_mm[0], 2, true), ShownFixed(edges.shift_mm[1], 2, true),
      ShownFixed(edges.shift_mm[2], 2, true));
}

void PrintJson(const contours::LabelEdges& edges) {
  const auto list = [](const std::vector<contours::LabelEdgeReport>& reports) {
    nlohmann::json all = nlohmann::json::array();
    for (const auto& report : reports) {
      all.push_back({{"name", report.name},
                     {"places", report.places},
                     {"seen", report.seen},
                     {"mean_mm", report.mean_mm},
                     {"median_mm", report.median_mm},
                     {"signed_mean_mm", report.signed_mean_mm},
                     {"within_1mm", report.within_1mm},
                     {"drawn_mm", report.drawn_mm}});
    }
    return all;
  };
  const nlohmann::json all = {
      {"as_given", list(edges.as_given)}, {"shifted", list(edges.shifted)}, {"shift_mm", edges.shift_mm}};
  std::printf("%s\n", all.dump(2).c_str());
}

core::Status Measure(const Arguments& arguments) {
  contours::LabelEdgeOptions options = arguments.options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  options.reference = arguments.reference;
  ProgressBar bar("measuring", 1.0);
  const auto edges = contours::MeasureLabelEdges(options, bar.Follow());
  bar.Finish();
  if (!edges) return edges.error();
  if (arguments.is_json) {
    PrintJson(*edges);
  } else {
    PrintForPerson(*edges);
  }
  return {};
}

}  // namespace

void AddAnatomyLabelEdgesCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "label-edges", "Measure how far a label map's borders lie from the edges that the pictures show");
  auto arguments = std::make_shared<Arguments>();
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
  command->add_flag("--json", arguments->is_json, "The table as JSON");
  command->footer(
      "Tells whether a label map can judge an edge follower at all, and whether it lies beside the pictures\n"
      "as a whole. Signed: positive where the edge lies outside the label.\n"
      "Example: trocar anatomy label-edges --images SLICES --reference LABELS.nii.gz \\\n"
      "           --control-points assets/patients/visible-human-male/control_points.json");
  command->callback([arguments, &outcome] { outcome.status = Measure(*arguments); });
}

}  // namespace trocar::cli
