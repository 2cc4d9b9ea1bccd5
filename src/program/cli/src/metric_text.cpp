// SPDX-License-Identifier: Apache-2.0
#include "metric_text.h"

#include <algorithm>
#include <utility>

#include "console.h"

namespace trocar::cli {

using host::Translate;

namespace {

using training::AttemptMetrics;
using training::MetricDefinition;
using training::MetricValue;

std::string ShownValue(const MetricDefinition& definition, const double* value) {
  return value == nullptr ? std::string() : host::ShownNumber(*value * definition.shown_scale, 4);
}

std::string BetterText(const MetricDefinition& definition) {
  return definition.better == training::BetterWhen::kNeither ? std::string()
                                                             : Translate(NameOf(definition.better));
}

std::string FormatTables(const std::vector<MetricRow>& rows) {
  std::vector<std::vector<std::string>> attempt = {{"whole", "value", "unit", "better"}};
  std::vector<std::vector<std::string>> hands = {{"hands", "left", "right", "unit", "better"}};
  for (const MetricRow& row : rows) {
    const MetricDefinition& d = *row.definition;
    if (!row.other.empty()) attempt.push_back({NameOfOther(d), row.other, d.shown_unit, BetterText(d)});
    if (!row.left.empty() || !row.right.empty())
      hands.push_back({Translate(d.name), row.left.empty() ? "-" : row.left,
                       row.right.empty() ? "-" : row.right, d.shown_unit, BetterText(d)});
  }
  std::string text;
  if (attempt.size() > 1) text += host::FormatShownTable(attempt);
  if (hands.size() > 1) text += (text.empty() ? "" : "\n") + host::FormatShownTable(hands);
  return text;
}

}  // namespace

std::string NameOfOther(const MetricDefinition& definition) {
  const bool is_camera = definition.of.size() > 1 && definition.of.back() == "camera";
  return Translate(definition.name) + (is_camera ? " (" + Translate("camera") + ")" : "");
}

std::vector<MetricRow> MakeMetricRows(const AttemptMetrics& metrics, std::string_view phase,
                                      std::string_view tool, bool every) {
  std::vector<MetricRow> rows;
  for (const MetricDefinition& definition : training::MetricDefinitions()) {
    const auto find = [&](std::string_view hand) {
      return ShownValue(definition, metrics.Find(definition.id, hand, phase, tool));
    };
    MetricRow row{&definition, find("left"), find("right"), find("")};
    if (row.other.empty()) row.other = find("camera");
    if (every || !row.left.empty() || !row.right.empty() || !row.other.empty())
      rows.push_back(std::move(row));
  }
  return rows;
}

std::string FormatMetricsText(const AttemptMetrics& metrics, bool has_parts) {
  std::string text = FormatTables(MakeMetricRows(metrics));
  if (!has_parts) return text;
  std::vector<std::pair<std::string, std::string>> parts;
  for (const MetricValue& value : metrics.values) {
    std::pair part{value.phase, value.tool};
    if ((value.phase.empty() && value.tool.empty()) ||
        std::find(parts.begin(), parts.end(), part) != parts.end())
      continue;
    parts.push_back(std::move(part));
  }
  for (const auto& [phase, tool] : parts) {
    text += "\n" +
            host::PrintableLine(tool.empty() ? host::TranslateWith("Phase: {1}", {ShownName(phase)})
                                             : host::TranslateWith("While using: {1}", {ShownName(tool)})) +
            "\n\n" + FormatTables(MakeMetricRows(metrics, phase, tool));
  }
  return text;
}

}  // namespace trocar::cli
