// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trocar/contours/contour_rehearsal.h"
#include "trocar/contours/label_edges.h"
#include "trocar/host/console.h"
#include "trocar/host/json_text.h"
#include "trocar/host/translate.h"

namespace trocar::contours {
namespace {

struct Spread {
  double mean = 0, deviation = 0, least = 0, most = 0;
};

Spread CalcSpread(const OrganRehearsal& organ, double (*value)(const RehearsalRun&)) {
  Spread spread;
  const auto n = static_cast<double>(organ.runs.size());
  for (const auto& run : organ.runs) spread.mean += value(run) / n;
  spread.least = spread.most = value(organ.runs.front());
  for (const auto& run : organ.runs) {
    const double off = value(run) - spread.mean;
    spread.deviation += off * off;
    spread.least = std::min(spread.least, value(run));
    spread.most = std::max(spread.most, value(run));
  }
  spread.deviation = n > 1 ? std::sqrt(spread.deviation / (n - 1)) : 0.0;
  return spread;
}

/// A measure of the table and its name in JSON.
struct Measure {
  const char* key;
  double (*value)(const RehearsalRun&);
};

constexpr Measure kMeasures[] = {
    {"error_placed_mm", [](const RehearsalRun& r) { return r.error_placed_mm; }},
    {"error_adapted_mm", [](const RehearsalRun& r) { return r.error_adapted_mm; }},
    {"dice_placed", [](const RehearsalRun& r) { return r.dice_placed; }},
    {"dice_adapted", [](const RehearsalRun& r) { return r.dice_adapted; }}};

}  // namespace

std::vector<std::vector<std::string>> Tabulate(const std::vector<OrganRehearsal>& organs) {
  std::vector<std::vector<std::string>> rows = {{"organ", "runs", "slices", "points", "inserted",
                                                 "point error placed [mm]", "adapted [mm]", "Dice placed",
                                                 "adapted"}};
  for (const auto& organ : organs) {
    std::size_t slices = 0, points = 0, inserted = 0;
    for (const auto& run : organ.runs) slices += run.slices, points += run.points, inserted += run.inserted;
    const std::size_t n = organ.runs.size();
    std::vector<std::string> row = {host::Translate(organ.name), std::to_string(n),
                                    std::to_string(slices / n), std::to_string(points / n),
                                    std::to_string(inserted / n)};
    for (const Measure& measure : kMeasures) {
      const Spread spread = CalcSpread(organ, measure.value);
      row.push_back(host::ShownFixed(spread.mean, 3) + " +- " + host::ShownFixed(spread.deviation, 3));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string FormatJson(const std::vector<OrganRehearsal>& organs) {
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
  return host::FormatJson(nlohmann::json{{"organs", list}}, 2) + "\n";
}

std::vector<std::vector<std::string>> Tabulate(const LabelEdges& edges) {
  std::vector<std::vector<std::string>> rows = {{"organ", "labels", "places", "edge seen",
                                                 "mean distance [mm]", "median", "signed mean", "within 1 mm",
                                                 "drawn contours [mm]"}};
  const auto add = [&](const std::vector<LabelEdgeReport>& reports, const std::string& labels) {
    for (const auto& report : reports) {
      rows.push_back({host::Translate(report.name), labels, std::to_string(report.places),
                      host::ShownFixed(report.seen, 2), host::ShownFixed(report.mean_mm, 2),
                      host::ShownFixed(report.median_mm, 2), host::ShownFixed(report.signed_mean_mm, 2, true),
                      host::ShownFixed(report.within_1mm, 2), host::ShownFixed(report.drawn_mm, 2)});
    }
  };
  add(edges.as_given, host::Translate("as given"));
  add(edges.shifted, host::Translate("shifted"));
  return rows;
}

std::string FormatJson(const LabelEdges& edges) {
  const auto list = [](const std::vector<LabelEdgeReport>& reports) {
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
  return host::FormatJson(all, 2) + "\n";
}

}  // namespace trocar::contours
