// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/metric_definition.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "metric_definitions_text.h"
#include "trocar/base/assert.h"
#include "trocar/host/json.h"

namespace trocar::training {
namespace {

using json = nlohmann::ordered_json;

/// A text, or nothing for null.
std::string TextOf(const json& object, const char* key) {
  const json& value = object.at(key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::vector<std::string> TextsOf(const json& object, const char* key) {
  return object.at(key).get<std::vector<std::string>>();
}

BetterWhen ReadBetter(const std::string& text) {
  for (const BetterWhen better : {BetterWhen::kHigher, BetterWhen::kLower}) {
    if (text == NameOf(better)) return better;
  }
  TROCAR_ASSERT(text == NameOf(BetterWhen::kNeither));  // delivered inside of the program
  return BetterWhen::kNeither;
}

Evidence ReadEvidence(const std::string& text) {
  for (std::size_t i = 0; i < kEvidenceCount; ++i) {
    if (text == NameOf(static_cast<Evidence>(i))) return static_cast<Evidence>(i);
  }
  TROCAR_ASSERT(false);  // delivered inside of the program
  return Evidence::kUnvalidated;
}

MetricDefinition ReadDefinition(const json& entry) {
  MetricDefinition d;
  d.id = TextOf(entry, "id");
  d.name = TextOf(entry, "name");
  d.about = TextOf(entry, "about");
  d.unit = TextOf(entry, "unit");
  const json& shown = entry.at("shown");
  d.shown_unit = shown.is_null() ? (d.unit == "1" ? "" : d.unit) : TextOf(shown, "unit");
  d.shown_scale = shown.is_null() ? 1.0 : shown.at("scale").get<double>();
  d.of = TextsOf(entry, "of");
  d.splits = TextsOf(entry, "splits");
  d.frame = TextOf(entry, "frame");
  d.sampling = TextOf(entry, "sampling");
  d.settings = TextsOf(entry, "settings");
  d.formula = TextOf(entry, "formula");
  d.undefined = TextOf(entry, "undefined");
  d.better = ReadBetter(TextOf(entry, "better"));
  d.source = TextOf(entry, "source");
  d.evidence = ReadEvidence(TextOf(entry, "evidence"));
  const json& names = entry.at("also_called");
  d.fls = TextOf(names, "fls");
  d.lapsim = TextOf(names, "lapsim");
  d.lap_mentor = TextOf(names, "lap_mentor");
  if (const json& tolerance = entry.at("tolerance"); !tolerance.is_null())
    d.tolerance = MetricTolerance{tolerance.at("rate").get<double>(), tolerance.at("noise").get<double>()};
  return d;
}

const json& DefinitionsDocument() {
  static const json document = host::ParseJson<json>(kMetricDefinitionsText, "the metrics").value();
  return document;
}

/// A row of a table; bars would end a cell.
std::string CellOf(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string JoinWords(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string NamesElsewhere(const MetricDefinition& d) {
  std::vector<std::string> names;
  if (!d.fls.empty()) names.push_back("FLS: " + d.fls);
  if (!d.lapsim.empty()) names.push_back("LapSim: " + d.lapsim);
  if (!d.lap_mentor.empty()) names.push_back("LAP Mentor: " + d.lap_mentor);
  return JoinWords(names);
}

}  // namespace

std::string_view NameOf(BetterWhen better) noexcept {
  switch (better) {
    case BetterWhen::kHigher:
      return "higher";
    case BetterWhen::kLower:
      return "lower";
    case BetterWhen::kNeither:
      break;
  }
  return "neither";
}

std::string_view NameOf(Evidence evidence) noexcept {
  constexpr std::array<std::string_view, kEvidenceCount> kNames = {
      "analytic", "measured against truth", "emulated", "scripted people only", "real people", "unvalidated"};
  return kNames[static_cast<std::size_t>(evidence)];
}

std::span<const MetricDefinition> MetricDefinitions() {
  static const std::vector<MetricDefinition> definitions = [] {
    std::vector<MetricDefinition> all;
    for (const json& entry : DefinitionsDocument().at("metrics")) all.push_back(ReadDefinition(entry));
    return all;
  }();
  return definitions;
}

const MetricDefinition* FindMetric(std::string_view id) {
  const auto all = MetricDefinitions();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& d) { return d.id == id; });
  return found == all.end() ? nullptr : &*found;
}

std::string_view MetricsDisclaimer() noexcept {
  return "training feedback, not certified assessment";
}

std::string_view MetricDefinitionsJson() noexcept {
  return kMetricDefinitionsText;
}

std::string FormatMetricDefinitionsPage() {
  const json& document = DefinitionsDocument();
  std::string page =
      "# Metrics\n\nWhat an attempt is measured by: " + std::string(MetricsDisclaimer()) +
      ". `trocar metrics RECORDING` prints them. The definitions\nstand in "
      "[metrics.json](metrics.json) for programs; this page is the output of `trocar metrics --list "
      "--markdown`, and a test compares\nthe two. [How they are computed, and how to check "
      "another implementation](metrics-check.md).\n\n" +
      document.at("about").get<std::string>() +
      "\n\nValues in files are in SI units; the unit in parentheses is what people are shown.\n\n## "
      "All metrics\n\n| id | name | what it is | unit | of, and for each | better | source | evidence | "
      "called "
      "elsewhere |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const MetricDefinition& d : MetricDefinitions()) {
    const bool has_other_unit = !d.shown_unit.empty() && d.shown_unit != d.unit;
    page += "| `" + d.id + "` | " + d.name + " | " + CellOf(d.about) + " | " + d.unit +
            (has_other_unit ? " (" + d.shown_unit + ")" : "") + " | " + JoinWords(d.of) +
            (d.splits.empty() ? "" : "; " + JoinWords(d.splits)) + " | " + std::string(NameOf(d.better)) +
            " | " + CellOf(d.source) + " | " + std::string(NameOf(d.evidence)) + " | " +
            CellOf(NamesElsewhere(d)) + " |\n";
  }
  page += "\n## How each is computed\n";
  for (const MetricDefinition& d : MetricDefinitions()) {
    page += "\n**" + d.name + "** (`" + d.id + "`, " + d.sampling +
            (d.frame.empty() ? "" : ", frame: " + d.frame) + "): " + d.formula + "." +
            (d.undefined.empty() ? "" : " No value: " + d.undefined + ".") +
            (d.settings.empty() ? "" : " Settings: " + JoinWords(d.settings) + ".") + "\n";
    if (d.tolerance) {
      char text[120];
      std::snprintf(text, sizeof text, "Moves by at most %g %% with the sampling rate, %g %% with noise.\n",
                    100 * d.tolerance->rate, 100 * d.tolerance->noise);
      page += text;
    }
  }
  page += "\n## Settings\n\n| setting | value | unit | what |\n|---|---|---|---|\n";
  for (const auto& [name, setting] : document.at("settings").items()) {
    page += "| `" + name + "` | " + setting.at("value").dump() + " | " + TextOf(setting, "unit") + " | " +
            CellOf(TextOf(setting, "about")) + " |\n";
  }
  return page;
}

}  // namespace trocar::training
