// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/report_files.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "trocar/host/csv_field.h"
#include "trocar/host/json_text.h"
#include "trocar/host/text_table.h"
#include "trocar/training/metric_definition.h"

namespace trocar::report {
namespace {

using host::FormatCsvField;
using nlohmann::ordered_json;

constexpr int kAllDigits = 17;

std::string SiUnit(const MetricRow& row) {
  const training::MetricDefinition* definition = training::FindMetric(row.id);
  return definition != nullptr ? definition->unit : "";
}

/// In SI again.
double SiValue(const MetricRow& row, double shown) {
  return row.scale != 0 ? shown / row.scale : shown;
}

std::string AllDigits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", kAllDigits, value);
  return text;
}

ordered_json OptionalText(const std::string& text) {
  return text.empty() ? ordered_json() : ordered_json(text);
}

ordered_json MetricJson(const MetricRow& row) {
  ordered_json json = {{"metric", row.id}, {"name", row.name}};
  for (const auto& [key, text] : {std::pair{"hand", &row.hand}, {"phase", &row.phase}, {"tool", &row.tool}}) {
    if (!text->empty()) json[key] = *text;
  }
  json["value"] = SiValue(row, row.value);
  json["unit"] = SiUnit(row);
  json["better"] = training::NameOf(row.better);
  if (row.expert_mean) json["expert_mean"] = SiValue(row, *row.expert_mean);
  if (row.expert_deviation) json["expert_deviation"] = SiValue(row, *row.expert_deviation);
  if (row.separates) json["separates_levels"] = *row.separates;
  json["evidence"] = training::NameOf(row.evidence);
  return json;
}

/// Fields other than metrics, of both files.
std::vector<FieldMeaning> FixedFields() {
  const std::string own = "Trocar";
  return {
      {"attempt.person", "pseudonym of the trainee; absent: nobody named", "", own},
      {"attempt.task", "task or operation, for a person", "", own},
      {"attempt.task_key", "its key", "", own},
      {"attempt.level", "difficulty of the task", "", own},
      {"attempt.patient", "patient in place of the scene's own", "", own},
      {"attempt.seed", "of the scene's random parameters", "", own},
      {"attempt.started", "wall clock with its offset, RFC 3339", "", own},
      {"attempt.player", "who or what moved the hands", "", own},
      {"attempt.program", "version of Trocar", "", own},
      {"attempt.recording", "file name of the recording", "", own},
      {"attempt.as_recorded",
       "whether the replay came to the outcome that the recording's file says; null where it was not read "
       "from a file",
       "", own},
      {"outcome.ending",
       "\"completed\", \"time_over\", \"error\" (one that ends the task), \"left\", or \"no_task\"", "", own},
      {"outcome.completed", "whether the task or operation was brought to its end", "", own},
      {"outcome.score", "score of the task; absent where it has none or was not completed",
       "% of an able surgeon's, or points", own},
      {"outcome.score_unit", "\"percent\" or \"points\"", "", own},
      {"outcome.time_s", "from the first tick to the last", "s", own},
      {"outcome.critical_view_s", "when the critical view of safety was first achieved", "s",
       "Strasberg et al. 1995"},
      {"outcome.blood_ml", "blood lost, of an operation", "mL", own},
      {"outcome.bile_ml", "bile spilled, of an operation", "mL", own},
      {"goals[].goal", "goal of the task", "", own},
      {"goals[].reached_s", "when it was reached; null: it was not", "s", own},
      {"errors[].time_s", "when, since the first tick", "s", own},
      {"errors[].severity", "\"minor\", \"major\" or \"critical\"", "", own},
      {"errors[].what", "a sentence", "", own},
      {"errors[].hand", "\"left\" or \"right\"; absent: neither", "", own},
      {"errors[].where", "organ or vessel", "", own},
      {"phases[].phase", "phase of the operation, names of Cholec80", "", "Twinanda et al. 2017"},
      {"phases[].start_s", "its begin", "s", own},
      {"phases[].end_s", "its end", "s", own},
      {"advice[].sentence", "what the coach saw", "", own},
      {"advice[].why", "why it matters", "", own},
      {"advice[].exercise", "key of a task that helps", "", own},
      {"advice[].time_s", "moment to look at", "s", own},
      {"metrics[].metric", "id of the measure, see below", "", own},
      {"metrics[].hand", "\"left\", \"right\" or \"camera\"; absent: the whole attempt", "", own},
      {"metrics[].phase", "only within this phase; absent: the whole attempt", "", own},
      {"metrics[].tool", "only while this tool was in use; absent: whatever tool", "", own},
      {"metrics[].value", "in the measure's SI unit", "see the measure", own},
      {"metrics[].expert_mean", "mean of the expert set, in the same unit", "see the measure", own},
      {"metrics[].expert_deviation", "standard deviation of the expert set", "see the measure", own},
      {"metrics[].separates_levels", "whether the measure tells scripted novices from scripted experts", "",
       own},
      {"metrics[].evidence", "the most that has been shown of the measure, see docs/evidence.md", "", own},
  };
}

}  // namespace

std::vector<FieldMeaning> MakeDataDictionary() {
  std::vector<FieldMeaning> dictionary = FixedFields();
  for (const training::MetricDefinition& definition : training::MetricDefinitions()) {
    std::string meaning = definition.name + ": " + definition.about;
    if (!definition.undefined.empty()) meaning += " Absent when: " + definition.undefined + ".";
    dictionary.push_back({definition.id, std::move(meaning), definition.unit, definition.source});
  }
  return dictionary;
}

std::string FormatDictionaryCsv() {
  std::string csv = "field,meaning,unit,source\r\n";
  for (const FieldMeaning& one : MakeDataDictionary())
    csv += FormatCsvField(one.field) + "," + FormatCsvField(one.meaning) + "," + FormatCsvField(one.unit) +
           "," + FormatCsvField(one.source) + "\r\n";
  return csv;
}

std::string FormatCsv(const AttemptReport& report) {
  const AttemptFacts& facts = report.facts;
  std::string csv =
      "person,task,level,patient,seed,started,program,metric,name,hand,phase,tool,value,unit,as_recorded\r\n";
  std::string of;
  for (const std::string& text : {facts.person, facts.task_key, facts.level, facts.patient})
    of += FormatCsvField(text) + ",";
  of += std::to_string(facts.seed) + "," + FormatCsvField(facts.started) + "," +
        FormatCsvField(facts.program) + ",";
  const std::string as_recorded = !facts.is_as_recorded ? "" : *facts.is_as_recorded ? "true" : "false";
  const auto add = [&](const std::string& metric, const std::string& name, const MetricRow& row, double value,
                       const std::string& unit) {
    csv += of + FormatCsvField(metric) + "," + FormatCsvField(name) + "," + FormatCsvField(row.hand) + "," +
           FormatCsvField(row.phase) + "," + FormatCsvField(row.tool) + "," + AllDigits(value) + "," +
           FormatCsvField(unit) + "," + as_recorded + "\r\n";
  };
  for (const MetricRow& row : report.metrics)
    add(row.id, row.name, row, SiValue(row, row.value), SiUnit(row));
  return csv;
}

std::string FormatJson(const AttemptReport& report) {
  const AttemptFacts& facts = report.facts;
  ordered_json json = {
      {"format", "trocar-report"}, {"version", 1}, {"disclaimer", training::MetricsDisclaimer()}};
  json["attempt"] = {
      {"person", OptionalText(facts.person)},
      {"task", facts.task},
      {"task_key", facts.task_key},
      {"level", OptionalText(facts.level)},
      {"patient", OptionalText(facts.patient)},
      {"seed", facts.seed},
      {"started", OptionalText(facts.started)},
      {"player", OptionalText(facts.player)},
      {"program", facts.program},
      {"recording", OptionalText(facts.recording)},
      {"as_recorded", facts.is_as_recorded ? ordered_json(*facts.is_as_recorded) : ordered_json()}};
  ordered_json& outcome = json["outcome"] = {
      {"ending", NameOf(report.ending)}, {"completed", report.is_completed}, {"time_s", report.seconds}};
  if (report.score && report.is_completed) {
    outcome["score"] = *report.score;
    outcome["score_unit"] = facts.best_score ? "percent" : "points";
  }
  if (report.critical_view_time) outcome["critical_view_s"] = *report.critical_view_time;
  if (report.blood_ml) outcome["blood_ml"] = *report.blood_ml;
  if (report.bile_ml) outcome["bile_ml"] = *report.bile_ml;
  for (const char* list : {"goals", "errors", "phases", "advice", "metrics"})
    json[list] = ordered_json::array();
  for (const GoalRow& goal : report.goals)
    json["goals"].push_back(
        {{"goal", goal.name}, {"reached_s", goal.time ? ordered_json(*goal.time) : ordered_json()}});
  for (const ErrorRow& error : report.errors) {
    ordered_json one = {
        {"time_s", error.time}, {"severity", surgery::NameOf(error.severity)}, {"what", error.what}};
    if (error.hand == 0 || error.hand == 1) one["hand"] = error.hand == 0 ? "left" : "right";
    if (!error.where.empty()) one["where"] = error.where;
    json["errors"].push_back(std::move(one));
  }
  for (const training::PhaseSpan& phase : report.phases)
    json["phases"].push_back({{"phase", phase.name}, {"start_s", phase.start}, {"end_s", phase.end}});
  for (const Advice& advice : report.advice) {
    ordered_json one = {{"sentence", advice.sentence}, {"why", advice.why}, {"exercise", advice.exercise}};
    if (advice.time) one["time_s"] = *advice.time;
    json["advice"].push_back(std::move(one));
  }
  for (const MetricRow& row : report.metrics) json["metrics"].push_back(MetricJson(row));
  json["dictionary"] = ordered_json::array();
  for (const FieldMeaning& one : MakeDataDictionary())
    json["dictionary"].push_back(
        {{"field", one.field}, {"meaning", one.meaning}, {"unit", one.unit}, {"source", one.source}});
  return host::FormatJson(json, 1) + "\n";
}

}  // namespace trocar::report
