// SPDX-License-Identifier: Apache-2.0
#include "judgement_text.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "console.h"
#include "trocar/training/metric_definition.h"

namespace trocar::cli {

using host::Mark;
using host::ShownNumber;
using host::Translate;

namespace {

using assessment::Better;

/// In the unit that people are shown.
std::string FormatMetric(const std::string& metric, double value) {
  const training::MetricDefinition* definition = training::FindMetric(metric);
  if (definition == nullptr) return ShownNumber(value);
  const std::string number = ShownNumber(value * definition->shown_scale);
  return definition->shown_unit.empty() ? number : number + " " + definition->shown_unit;
}

std::string FormatBound(const assessment::Threshold& threshold) {
  return host::TranslateWith(threshold.better == Better::kLower ? Mark("at most {1}") : Mark("at least {1}"),
                             {FormatMetric(threshold.of.metric, threshold.value)});
}

/// As assessment::TextOf, for a person: the metric's own name and the hand.
std::string ShownKey(const assessment::MetricKey& key) {
  const training::MetricDefinition* definition = training::FindMetric(key.metric);
  std::string text = definition != nullptr ? Translate(definition->name) : key.metric;
  if (!key.hand.empty())
    text += ", " + (key.hand == "camera" ? Translate("camera")
                    : key.hand == "left" ? Translate("left hand")
                                         : Translate("right hand"));
  return key.phase.empty() ? text : host::TranslateWith("{1}, in {2}", {text, Translate(key.phase)});
}

}  // namespace

std::string DescribeThreshold(const assessment::Threshold& threshold) {
  return ShownKey(threshold.of) + ": " + FormatBound(threshold) + " (" +
         Translate(NameOf(threshold.purpose)) + ")";
}

void PrintVerdict(const assessment::Verdict& verdict) {
  if (!verdict.is_completed) host::Say("  not completed\n");
  std::vector<std::vector<std::string>> rows = {{"", "metric", "reached", "needed", "for"}};
  for (const auto& one : verdict.metrics) {
    const auto& threshold = one.threshold;
    rows.push_back({Translate(one.is_met    ? Mark("met")
                              : one.is_open ? Mark("not finished")
                                            : Mark("MISSED")),
                    ShownKey(threshold.of),
                    one.value ? FormatMetric(threshold.of.metric, *one.value) : Translate("not defined"),
                    FormatBound(threshold), Translate(NameOf(threshold.purpose))});
  }
  if (rows.size() > 1) host::PrintTable(rows);
  if (verdict.composite) {
    if (!verdict.grade.empty()) host::Print(verdict.grade + ": ");
    host::Say(*verdict.composite < 0 ? "{1} deviations below the mean of the expert set\n"
                                     : "{1} deviations above the mean of the expert set\n",
              ShownNumber(std::abs(*verdict.composite), 3));
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
                                  {"not_finished", one.is_open},
                                  {"margin", one.margin}};
    if (one.value) row["value"] = *one.value;
    json["metrics"].push_back(std::move(row));
  }
  return json;
}

}  // namespace trocar::cli
