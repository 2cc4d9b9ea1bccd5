// SPDX-License-Identifier: Apache-2.0
#include "judgement_text.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "console.h"
#include "trocar/training/metric_definition.h"

namespace trocar::cli {
namespace {

using assessment::Better;

/// In the unit that people are shown.
std::string FormatMetric(const std::string& metric, double value) {
  const training::MetricDefinition* definition = training::FindMetric(metric);
  if (definition == nullptr) return FormatNumber(value);
  const std::string number = FormatNumber(value * definition->shown_scale);
  return definition->shown_unit.empty() ? number : number + " " + definition->shown_unit;
}

}  // namespace

std::string WrapText(const std::string& text, std::size_t width, const std::string& indent) {
  std::istringstream words(text);
  std::string wrapped, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent.size() + line.size() + 1 + word.size() > width) {
      wrapped += indent + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? wrapped : wrapped + indent + line + "\n";
}

std::string DescribeThreshold(const assessment::Threshold& threshold) {
  return TextOf(threshold.of) + ": " + (threshold.better == Better::kLower ? "at most " : "at least ") +
         FormatMetric(threshold.of.metric, threshold.value) + " (" + std::string(NameOf(threshold.purpose)) +
         ")";
}

void PrintVerdict(const assessment::Verdict& verdict) {
  if (!verdict.is_completed) std::printf("  not completed\n");
  std::vector<std::vector<std::string>> rows = {{"", "metric", "reached", "needed", "for"}};
  for (const auto& one : verdict.metrics) {
    const auto& threshold = one.threshold;
    rows.push_back({one.is_met ? "met" : "MISSED", TextOf(threshold.of),
                    one.value ? FormatMetric(threshold.of.metric, *one.value) : "not defined",
                    (threshold.better == Better::kLower ? "at most " : "at least ") +
                        FormatMetric(threshold.of.metric, threshold.value),
                    std::string(NameOf(threshold.purpose))});
  }
  if (rows.size() > 1) std::fputs(FormatTable(rows).c_str(), stdout);
  if (verdict.composite) {
    std::printf("%s%s deviations %s the mean of the expert set\n",
                verdict.grade.empty() ? "" : (verdict.grade + ": ").c_str(),
                FormatNumber(std::abs(*verdict.composite), 3).c_str(),
                *verdict.composite < 0 ? "below" : "above");
  }
}

nlohmann::ordered_json VerdictJson(const assessment::Verdict& verdict) {
  nlohmann::ordered_json json = {{"passed", verdict.is_passed}, {"completed", verdict.is_completed},
                                 {"safe", verdict.is_safe},     {"composite", nullptr},
                                 {"grade", verdict.grade},      {"metrics", nlohmann::ordered_json::array()}};
  if (verdict.composite) json["composite"] = *verdict.composite;
  for (const auto& one : verdict.metrics) {
    const auto& threshold = one.threshold;
    nlohmann::ordered_json row = {{"metric", threshold.of.metric},
                                  {"hand", threshold.of.hand},
                                  {"phase", threshold.of.phase},
                                  {"purpose", NameOf(threshold.purpose)},
                                  {"better", threshold.better == Better::kLower ? "lower" : "higher"},
                                  {"threshold", threshold.value},
                                  {"value", nullptr},
                                  {"met", one.is_met},
                                  {"margin", one.margin}};
    if (one.value) row["value"] = *one.value;
    json["metrics"].push_back(std::move(row));
  }
  return json;
}

}  // namespace trocar::cli
