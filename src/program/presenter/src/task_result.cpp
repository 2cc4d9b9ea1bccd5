// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/task_result.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "trocar/base/assert.h"
#include "trocar/host/json_text.h"
#include "trocar/host/markup.h"
#include "trocar/host/translate.h"
#include "trocar/host/version.h"
#include "trocar/presenter/read_outs.h"

namespace trocar::presenter {
namespace {

using host::EscapeMarkup;
using scene::TaskPhase;

constexpr const char* kStyle = R"(
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1d2327; background: #fff; margin: 0 auto;
  max-width: 50rem; padding: 1.5rem; }
h1 { font-size: 1.6rem; margin: 0; } h2 { font-size: 1.1rem; margin: 1.8rem 0 .3rem; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #dcdcde; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.done { color: #00693e; } .open { color: #8a5a00; } .critical { color: #a4161a; font-weight: 600; }
)";

std::string VerdictOf(TaskPhase phase) {
  switch (phase) {
    case TaskPhase::kCompleted:
      return host::Translate("Completed");
    case TaskPhase::kTimeOver:
      return host::Translate("The time is over");
    case TaskPhase::kEnded:
      return host::Translate("Ended by an error");
    default:
      return host::Translate("Not finished");
  }
}

std::string FormatPoints(double points) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", points);
  return host::LocalNumber(text);
}

}  // namespace

void TaskErrorLog::Add(const scene::TaskSnapshot& now) {
  if (now.error_count < seen_) {
    errors_.clear();
    seen_ = 0;
  }
  const auto ring = static_cast<std::uint64_t>(now.last_errors.size());
  for (seen_ = std::max(seen_, now.error_count > ring ? now.error_count - ring : 0); seen_ < now.error_count;
       ++seen_)
    errors_.push_back(now.last_errors[seen_ % ring]);
}

TaskResult MakeTaskResult(const scene::Scene& scene, const scene::TaskSnapshot& now,
                          const std::vector<scene::TaskError>& errors) {
  TROCAR_ASSERT(scene.task.has_value());
  const scene::Task& task = *scene.task;
  TaskResult result;
  result.task = task.name;
  result.level = task.level;
  result.seed = scene.seed;
  result.phase = now.phase;
  result.verdict = VerdictOf(now.phase);
  result.time = now.time;
  result.score = scene::CalcShownScore(task, now);
  result.best_score = task.best_score;
  result.is_score_percent = task.reference_points > 0;
  for (std::size_t g = 0; g < task.goals.size(); ++g)
    result.goals.push_back({task.goals[g].name, g < now.goals.size() && now.goals[g].is_done});
  for (const scene::TaskError& error : errors) {
    const scene::ErrorRule& rule = task.errors[static_cast<std::size_t>(error.rule)];
    TaskResult::ErrorRow row{
        error.time, rule.name,    rule.about,    std::string(surgery::NameOf(rule.severity)),
        "",         rule.penalty, error.position};
    if (error.object >= 0) row.by = scene.objects[static_cast<std::size_t>(error.object)].name;
    if (error.hand >= 0)
      row.by += (row.by.empty() ? "" : ", ") +
                std::string(error.hand == instrument::kLeft ? "left hand" : "right hand");
    result.errors.push_back(std::move(row));
  }
  return result;
}

std::string FormatScore(const TaskResult& result) {
  char text[32];
  if (result.is_score_percent) {
    std::snprintf(text, sizeof text, "%.1f", result.score);
    return host::TranslateWith("{1} of {2}",
                               {host::LocalNumber(text), std::to_string(std::lround(result.best_score))});
  }
  std::snprintf(text, sizeof text, "%.1f", result.score);
  return host::TranslateWith("{1} points", {host::LocalNumber(text)});
}

std::string DescribeDoer(const TaskResult::ErrorRow& error) {
  // "ring_1, left hand", each in words
  std::string text;
  for (std::size_t at = 0; at < error.by.size();) {
    const std::size_t end = std::min(error.by.find(", ", at), error.by.size());
    std::string name = error.by.substr(at, end - at);
    std::replace(name.begin(), name.end(), '_', ' ');
    text += (text.empty() ? "" : ", ") + host::TranslateComposed(name);
    at = end + 2;
  }
  return text;
}

std::string FormatTaskResultJson(const TaskResult& result) {
  nlohmann::ordered_json json = {{"format", "trocar-task-result"},
                                 {"version", 1},
                                 {"task", result.task},
                                 {"level", result.level},
                                 {"seed", result.seed},
                                 {"demonstration", result.is_demonstration},
                                 {"phase", scene::PhaseName(result.phase)},
                                 {"time_s", result.time},
                                 {"score", result.score},
                                 {"score_unit", result.is_score_percent ? "of_best_score" : "points"},
                                 {"best_score", result.best_score},
                                 {"recording", result.recording},
                                 {"goals", nlohmann::ordered_json::array()},
                                 {"errors", nlohmann::ordered_json::array()}};
  for (const TaskResult::GoalRow& goal : result.goals)
    json["goals"].push_back({{"goal", goal.name}, {"done", goal.is_done}});
  for (const TaskResult::ErrorRow& error : result.errors) {
    json["errors"].push_back(
        {{"error", error.name},
         {"about", error.about},
         {"severity", error.severity},
         {"time_s", error.time},
         {"by", error.by},
         {"penalty", error.penalty},
         {"at_mm", {1e3 * error.position.x, 1e3 * error.position.y, 1e3 * error.position.z}}});
  }
  return host::FormatJson(json, 2) + "\n";
}

std::string FormatTaskResultHtml(const TaskResult& result) {
  const auto say = [](const std::string& text) { return EscapeMarkup(text); };
  const std::string task = say(host::Translate(result.task));
  std::string html = "<!DOCTYPE html>\n<html lang=\"" + host::Translate("en") +
                     "\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + task + " - Trocar</title>\n<style>" +
                     kStyle + "</style>\n</head>\n<body>\n<h1>" + task + "</h1>\n<p>" +
                     say(host::TranslateWith("{1} after {2} (min:s). Score {3}. Level {4}, variant {5}.",
                                             {result.verdict, FormatTime(result.time), FormatScore(result),
                                              host::Translate(result.level), std::to_string(result.seed)}));
  if (result.is_demonstration) html += " " + say(host::Translate("A demonstration by the scripted expert."));
  html += "</p>\n<h2>" + say(host::Translate("Goals")) + "</h2>\n<table>\n";
  for (const TaskResult::GoalRow& goal : result.goals)
    html += "<tr><td>" + say(host::TranslateComposed(goal.name)) + "</td><td class=\"" +
            (goal.is_done ? "done\">" + say(host::Translate("done"))
                          : "open\">" + say(host::TranslateIn("goal", "open"))) +
            "</td></tr>\n";
  html += "</table>\n<h2>" + say(host::Translate("Errors")) + "</h2>\n";
  if (result.errors.empty()) {
    html += "<p>" + say(host::Translate("None.")) + "</p>\n";
  } else {
    html += "<table>\n<tr>";
    for (const char* head : {host::Mark("At"), host::Mark("Error"), host::Mark("Severity"), host::Mark("By"),
                             host::Mark("Points")})
      html += "<th>" + say(host::Translate(head)) + "</th>";
    html += "</tr>\n";
    for (const TaskResult::ErrorRow& error : result.errors) {
      html += "<tr><td class=\"number\">" + FormatTime(error.time) + "</td><td>" +
              say(host::TranslateComposed(error.about)) + "</td><td class=\"" + error.severity + "\">" +
              say(host::Translate(error.severity)) + "</td><td>" + say(DescribeDoer(error)) +
              "</td><td class=\"number\">-" + FormatPoints(error.penalty) + "</td></tr>\n";
    }
    html += "</table>\n";
  }
  return html + "<p>" + say(host::Translate("Training feedback, not certified assessment.")) + " Trocar " +
         say(std::string(host::VersionText())) + ".</p>\n</body>\n</html>\n";
}

}  // namespace trocar::presenter
