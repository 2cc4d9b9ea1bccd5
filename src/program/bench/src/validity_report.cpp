// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "page_style.h"
#include "trocar/bench/svg_plot.h"
#include "trocar/bench/validity_study.h"
#include "trocar/host/json_text.h"
#include "trocar/host/markup.h"
#include "trocar/host/version.h"
#include "trocar/training/metric_definition.h"

namespace trocar::bench {
namespace {

using host::EscapeMarkup;
using nlohmann::ordered_json;

constexpr int kMostPlots = 4;  // of a task
constexpr double kGoodIcc = 0.75;

std::string Number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string Number(const std::optional<double>& value) {
  return value ? Number(*value, 3) : "-";
}

/// What a surgeon calls it, in the unit that is shown to people.
struct Shown {
  std::string name, unit;
  double scale = 1;
};

Shown ShownOf(const MetricFinding& finding) {
  Shown shown{finding.metric, "", 1};
  if (const training::MetricDefinition* definition = training::FindMetric(finding.metric)) {
    shown.name = definition->name;
    shown.unit = definition->shown_unit;
    shown.scale = definition->shown_scale;
  } else if (finding.metric.starts_with("coach:")) {
    shown.name = "Coach: " + finding.metric.substr(6);
    std::replace(shown.name.begin(), shown.name.end(), '_', ' ');
  }
  if (!finding.hand.empty()) shown.name += ", " + finding.hand;
  return shown;
}

std::string RangeText(double low, double high, const Shown& shown) {
  return Number(shown.scale * std::min(low, high)) + " to " + Number(shown.scale * std::max(low, high));
}

/// Whether it was done on several patients.
bool HasPatients(const TaskFindings& task) {
  return std::any_of(task.metrics.begin(), task.metrics.end(),
                     [](const MetricFinding& finding) { return finding.patient_icc.has_value(); });
}

void AddMetricTable(std::string& page, const TaskFindings& task) {
  page +=
      "<table><tr><th>metric</th><th>unit</th><th>novices</th><th>experts</th><th>effect</th><th>AUC</th>"
      "<th>ICC</th><th>alpha</th>" +
      std::string(HasPatients(task) ? "<th>ICC over patients</th>" : "") + "<th></th></tr>\n";
  for (const MetricFinding& finding : task.metrics) {
    const Shown shown = ShownOf(finding);
    page += "<tr><td>" + EscapeMarkup(shown.name) + "</td><td>" + EscapeMarkup(shown.unit) +
            "</td><td class=\"number\">" + RangeText(finding.novice_low, finding.novice_high, shown) +
            "</td><td class=\"number\">" + RangeText(finding.expert_low, finding.expert_high, shown) +
            "</td><td class=\"number\">" + Number(finding.effect) + "</td><td class=\"number\">" +
            Number(finding.auc, 3) + "</td><td class=\"number\">" + Number(finding.icc) +
            "</td><td class=\"number\">" + Number(finding.alpha) +
            (HasPatients(task) ? "</td><td class=\"number\">" + Number(finding.patient_icc) : "") +
            "</td><td class=\"" +
            (finding.separates     ? "pass\">separates"
             : finding.is_reversed ? "fail\">separates the wrong way round"
                                   : "limit\">does not separate") +
            "</td></tr>\n";
  }
  page += "</table>\n";
}

/// Share of people at or below each value, one line a level.
std::string DistributionPlot(const MetricFinding& finding, const std::string& task,
                             const std::vector<StudyAttempt>& attempts) {
  const Shown shown = ShownOf(finding);
  std::vector<PlotLine> lines;
  for (const char* level : {"novice", "intermediate", "expert"}) {
    std::vector<double> values;
    for (const StudyAttempt& attempt : attempts) {
      if (attempt.task != task || attempt.group != level) continue;
      for (const StudyValue& value : attempt.values) {
        if (value.metric == finding.metric && value.hand == finding.hand)
          values.push_back(shown.scale * value.value);
      }
    }
    std::sort(values.begin(), values.end());
    PlotLine line{level, {}};
    for (std::size_t i = 0; i < values.size(); ++i) {
      line.points.push_back({values[i], static_cast<double>(i) / static_cast<double>(values.size())});
      line.points.push_back({values[i], static_cast<double>(i + 1) / static_cast<double>(values.size())});
    }
    lines.push_back(std::move(line));
  }
  PlotSettings plot;
  plot.title = shown.name;
  plot.x_label = shown.unit.empty() ? "value" : shown.unit;
  plot.y_label = "share of attempts";
  plot.height = 200;
  return FormatSvgPlot(plot, lines);
}

void AddTask(std::string& page, const TaskFindings& task, const std::vector<StudyAttempt>& attempts) {
  const auto separating = std::count_if(task.metrics.begin(), task.metrics.end(),
                                        [](const MetricFinding& finding) { return finding.separates; });
  page += "<h2>" + EscapeMarkup(task.task) + ", level " + EscapeMarkup(task.level) + "</h2>\n<p>" +
          std::to_string(task.attempts) + " attempts, " + std::to_string(task.completed) +
          " of them completed: " + std::to_string(task.novices) + " by novices, " +
          std::to_string(task.middles) + " by intermediates, " + std::to_string(task.experts) +
          " by experts, the rest by people with one weakness or one error. <b>" + std::to_string(separating) +
          " of " + std::to_string(task.metrics.size()) +
          " numbers separate novices and experts without overlap.</b></p>\n";
  int plots = 0;
  for (const MetricFinding& finding : task.metrics) {
    if (!finding.separates || plots++ >= kMostPlots) continue;
    page += DistributionPlot(finding, task.task, attempts);
  }
  AddMetricTable(page, task);
  if (!task.clusters.empty()) {
    page +=
        "<h3>Numbers that say the same</h3><p>Rank correlation above 0.9; one of each line is "
        "enough.</p><ul>\n";
    for (const auto& cluster : task.clusters) {
      page += "<li>";
      for (std::size_t i = 0; i < cluster.size(); ++i) page += (i > 0 ? "; " : "") + EscapeMarkup(cluster[i]);
      page += "</li>\n";
    }
    page += "</ul>\n";
  }
  if (!task.groups.empty()) {
    page +=
        "<h3>People with one weakness, or one "
        "error</h3><table><tr><th>who</th><th>attempts</th><th>completed</th>"
        "<th>error found</th><th>shows most in</th><th>AUC</th></tr>\n";
    for (const GroupFinding& group : task.groups) {
      page += "<tr><td>" + EscapeMarkup(group.group) + "</td><td class=\"number\">" +
              std::to_string(group.attempts) + "</td><td class=\"number\">" +
              std::to_string(group.completed) + "</td><td class=\"number\">" + std::to_string(group.caught) +
              "</td><td>" + EscapeMarkup(group.best_metric) + "</td><td class=\"number\">" +
              Number(group.best_auc, 3) + "</td></tr>\n";
    }
    page += "</table>\n";
  }
  if (!task.left_out.empty()) {
    page += "<p>Not defined in enough attempts: ";
    for (std::size_t i = 0; i < task.left_out.size(); ++i)
      page += (i > 0 ? "; " : "") + EscapeMarkup(task.left_out[i]);
    page += ".</p>\n";
  }
}

ordered_json OrNull(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

}  // namespace

std::string FormatStudyPage(const StudyOptions& options, const std::vector<TaskFindings>& findings,
                            const std::vector<StudyAttempt>& attempts, const std::string& machine) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Validity study</title><style>";
  page += kPageStyle;
  page += kPlotStyle;
  page += "</style></head><body>\n<h1>Which metrics find out who is a novice?</h1>\n<p>" +
          std::to_string(attempts.size()) + " attempts by scripted people; " +
          std::to_string(options.people) + " people of each group, who differ by up to " +
          Number(100 * options.spread, 3) + " %, seed " + std::to_string(options.seed) + ". Trocar " +
          EscapeMarkup(host::VersionText()) + ", " + EscapeMarkup(machine) +
          ".</p>\n<p>The people are made by a program. What separates them may not separate residents; what "
          "does not "
          "separate them will hardly separate anybody. This is no study of people and sets no standard of "
          "competence. " +
          EscapeMarkup(training::MetricsDisclaimer()) +
          ".</p>\n<p><b>Separates</b>: no value of a novice lies within the range of the experts' values, "
          "nor the other way "
          "round, and the novices' values are the worse ones; of what is better neither way, any gap counts. "
          "<b>Effect</b>: novices minus experts, in pooled standard deviations. <b>AUC</b>: the "
          "chance that a novice's "
          "value is worse than an expert's; 0.5 says nothing. <b>ICC</b>(1,1) and Cronbach's <b>alpha</b>: "
          "how well an attempt "
          "repeats on another seed, over people of all three levels; above " +
          Number(kGoodIcc, 3) +
          " is good. <b>ICC over patients</b>: the same of attempts by the same hands on other generated "
          "patients.</p>\n";
  for (const TaskFindings& task : findings) AddTask(page, task, attempts);
  page += "</body></html>\n";
  return page;
}

std::string FormatStudyJson(const StudyOptions& options, const std::vector<TaskFindings>& findings) {
  ordered_json tasks = ordered_json::array();
  for (const TaskFindings& task : findings) {
    ordered_json metrics = ordered_json::array(), groups = ordered_json::array();
    for (const MetricFinding& f : task.metrics) {
      metrics.push_back(
          {{"metric", f.metric},
           {"hand", f.hand},
           {"separates", f.separates},
           {"ordered", f.is_ordered},
           {"auc", f.auc},
           {"effect", OrNull(f.effect)},
           {"icc", OrNull(f.icc)},
           {"alpha", OrNull(f.alpha)},
           {"patient_icc", OrNull(f.patient_icc)},
           {"novice", {{"low", f.novice_low}, {"high", f.novice_high}, {"mean", f.novice_mean}}},
           {"intermediate", {{"mean", f.middle_mean}}},
           {"expert",
            {{"low", f.expert_low}, {"high", f.expert_high}, {"mean", f.expert_mean}, {"sd", f.expert_sd}}},
           {"novices", f.novices},
           {"experts", f.experts}});
    }
    for (const GroupFinding& g : task.groups) {
      groups.push_back({{"group", g.group},
                        {"attempts", g.attempts},
                        {"completed", g.completed},
                        {"caught", g.caught},
                        {"best_metric", g.best_metric},
                        {"best_auc", g.best_auc}});
    }
    tasks.push_back({{"task", task.task},
                     {"level", task.level},
                     {"attempts", task.attempts},
                     {"completed", task.completed},
                     {"metrics", std::move(metrics)},
                     {"same", task.clusters},
                     {"groups", std::move(groups)},
                     {"left_out", task.left_out}});
  }
  const ordered_json all = {{"program", std::string(host::VersionText())},
                            {"people", options.people},
                            {"repeats", options.repeats},
                            {"patients", options.patients},
                            {"spread", options.spread},
                            {"seed", options.seed},
                            {"disclaimer", std::string(training::MetricsDisclaimer())},
                            {"tasks", std::move(tasks)}};
  return host::FormatJson(all, 2) + "\n";
}

std::string FormatStudyCsv(const std::vector<TaskFindings>& findings) {
  std::string csv =
      "task,level,metric,hand,separates,ordered,auc,effect,icc,alpha,novice_low,novice_high,novice_mean,"
      "intermediate_mean,"
      "expert_low,expert_high,expert_mean,expert_sd,patient_icc,novices,experts\n";
  const auto cell = [](const std::optional<double>& value) {
    return value ? Number(*value, 9) : std::string();
  };
  for (const TaskFindings& task : findings) {
    for (const MetricFinding& f : task.metrics) {
      csv += task.task + "," + task.level + "," + f.metric + "," + f.hand + "," +
             (f.separates ? "yes" : "no") + "," + (f.is_ordered ? "yes" : "no");
      for (const auto& value :
           {std::optional(f.auc), f.effect, f.icc, f.alpha, std::optional(f.novice_low),
            std::optional(f.novice_high), std::optional(f.novice_mean), std::optional(f.middle_mean),
            std::optional(f.expert_low), std::optional(f.expert_high), std::optional(f.expert_mean),
            std::optional(f.expert_sd), f.patient_icc})
        csv += "," + cell(value);
      csv += "," + std::to_string(f.novices) + "," + std::to_string(f.experts) + "\n";
    }
  }
  return csv;
}

std::string FormatValidityJson(const StudyOptions& options, const std::vector<TaskFindings>& findings) {
  // few enough digits to read, enough for thresholds in standard deviations
  const auto round = [](double value) { return std::stod(Number(value, 6)); };
  ordered_json tasks = ordered_json::array();
  for (const TaskFindings& task : findings) {
    ordered_json measures = ordered_json::array();
    for (const MetricFinding& f : task.metrics) {
      ordered_json measure = {{"metric", f.metric}};
      if (!f.hand.empty()) measure["hand"] = f.hand;
      measure.update({{"separates", f.separates},
                      {"auc", round(f.auc)},
                      {"expert_mean", round(f.expert_mean)},
                      {"expert_sd", round(f.expert_sd)},
                      {"experts", f.experts}});
      measures.push_back(std::move(measure));
    }
    tasks.push_back(
        {{"task", task.task},
         {"level", task.level},
         {"people", {{"novice", task.novices}, {"intermediate", task.middles}, {"expert", task.experts}}},
         {"measures", std::move(measures)}});
  }
  const ordered_json all = {
      {"format", "trocar-validity"},
      {"version", 1},
      {"about",
       "Which numbers separate scripted novices and experts without overlap, and what scripted experts "
       "reach. Written by "
       "trocar study; the people are made by a program, so that this sets no standard of competence."},
      {"study",
       {{"program", std::string(host::VersionText())},
        {"people", options.people},
        {"repeats", options.repeats},
        {"spread", options.spread},
        {"seed", options.seed}}},
      {"tasks", std::move(tasks)}};
  return host::FormatJson(all, 1) + "\n";
}

}  // namespace trocar::bench
