// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/contours/contour_rehearsal.h"

namespace trocar::cli {
namespace {

struct Spread {
  double mean = 0, deviation = 0, least = 0, most = 0;
};

Spread CalcSpread(const contours::OrganRehearsal& organ, double (*value)(const contours::RehearsalRun&)) {
  Spread spread;
  const auto n = static_cast<double>(organ.runs.size());
  for (const auto& run : organ.runs) spread.mean += value(run) / n;
  spread.least = spread.most = value(organ.runs.front());
  for (const auto& run : organ.runs) {
    spread.deviation += std::pow(value(run) - spread.mean, 2);
    spread.least = std::min(spread.least, value(run));
    spread.most = std::max(spread.most, value(run));
  }
  spread.deviation = n > 1 ? std::sqrt(spread.deviation / (n - 1)) : 0.0;
  return spread;
}

/// A measure of the table and its name in JSON.
struct Measure {
  const char* key;
  double (*value)(const contours::RehearsalRun&);
};

constexpr Measure kMeasures[] = {
    {"error_placed_mm", [](const contours::RehearsalRun& r) { return r.error_placed_mm; }},
    {"error_adapted_mm", [](const contours::RehearsalRun& r) { return r.error_adapted_mm; }},
    {"dice_placed", [](const contours::RehearsalRun& r) { return r.dice_placed; }},
    {"dice_adapted", [](const contours::RehearsalRun& r) { return r.dice_adapted; }}};

void PrintForPerson(const std::vector<contours::OrganRehearsal>& organs) {
  std::vector<std::vector<std::string>> rows = {{"organ", "runs", "slices", "points", "inserted",
                                                 "point error placed [mm]", "adapted [mm]", "Dice placed",
                                                 "adapted"}};
  for (const auto& organ : organs) {
    std::size_t slices = 0, points = 0, inserted = 0;
    for (const auto& run : organ.runs) slices += run.slices, points += run.points, inserted += run.inserted;
    const std::size_t n = organ.runs.size();
    std::vector<std::string> row = {Translate(organ.name), std::to_string(n), std::to_string(slices / n),
                                    std::to_string(points / n), std::to_string(inserted / n)};
    for (const Measure& measure : kMeasures) {
      const Spread spread = CalcSpread(organ, measure.value);
      row.push_back(ShownFixed(spread.mean, 3) + " +- " + ShownFixed(spread.deviation, 3));
    }
    rows.push_back(std::move(row));
  }
  PrintTable(rows);
}

void PrintJson(const std::vector<contours::OrganRehearsal>& organs) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& organ : organs) {
    nlohmann::json entry = {{"name", organ.name}, {"runs", nlohmann::json::array()}};
    for (const auto& run : organ.runs) {
      nlohmann::json one = {{"seed", run.seed},
                            {"slices", run.slices},
                            {"points", run.points},
                            {"inserted", run.inserted},
                            {"notes", run.notes}};
      for (const Measure& measure : kMeasures) one[measure.key] = measure.value(run);
      entry["runs"].push_back(one);
    }
    for (const Measure& measure : kMeasures) {
      const Spread spread = CalcSpread(organ, measure.value);
      entry[measure.key] = {{"mean", spread.mean},
                            {"deviation", spread.deviation},
                            {"least", spread.least},
                            {"most", spread.most}};
    }
    list.push_back(entry);
  }
  std::printf("%s\n", nlohmann::json{{"organs", list}}.dump(2).c_str());
}

struct Arguments {
  contours::RehearsalOptions options;
  std::string control_points, images, reference, overlays;
  std::vector<int> points = {8, 12};
  bool is_json = false;
};

core::Status Rehearse(const Arguments& arguments) {
  contours::RehearsalOptions options = arguments.options;
  options.control_points = arguments.control_points;
  options.images = arguments.images;
  options.reference = arguments.reference;
  options.clicks.points = {arguments.points.front(), arguments.points.back()};
  if (!arguments.overlays.empty()) options.overlays = arguments.overlays;
  ProgressBar bar("rehearsing", 1.0);
  const auto organs = contours::RehearseContours(options, bar.Follow());
  bar.Finish();
  if (!organs) return organs.error();
  if (arguments.is_json) {
    PrintJson(*organs);
  } else {
    PrintForPerson(*organs);
  }
  return {};
}

}  // namespace

void AddAnatomyRehearseCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "rehearse", "Simulate a user who clicks contours, and measure what the chain makes of the clicks");
  auto arguments = std::make_shared<Arguments>();
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
  command->add_flag("--json", arguments->is_json, "Every run as JSON");
  command->footer(
      "Point error: mean distance to the reference's outline. Dice: of the finished mesh against the "
      "reference.\n"
      "Example: trocar anatomy rehearse --images SLICES --reference LABELS.nii.gz \\\n"
      "           --control-points assets/patients/visible-human-male/control_points.json");
  command->callback([arguments, &outcome] { outcome.status = Rehearse(*arguments); });
}

}  // namespace trocar::cli
