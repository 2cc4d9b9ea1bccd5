// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/attempt_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "trocar/host/translate.h"
#include "trocar/record/recording.h"
#include "trocar/report/axis.h"

namespace trocar::report {

using math::Vec2;

namespace {

using training::AttemptTrace;

constexpr std::size_t kMostForcePoints = 1600;  // two to a pixel of the time line
constexpr std::size_t kMostPathPoints = 3000;
constexpr double kPathStep = 0.25;   // tips that moved less are not drawn again [mm]
constexpr double kMillimetre = 1e3;  // per m
constexpr double kMillilitre = 1e6;  // per m^3

std::string CountGoals(const AttemptTrace& trace) {
  if (trace.goals.empty()) return "";
  const auto done = std::count_if(trace.goals.begin(), trace.goals.end(),
                                  [](const training::GoalRecord& goal) { return goal.time.has_value(); });
  return host::TranslateWith(", with {1} of {2} goals reached",
                             {std::to_string(done), std::to_string(trace.goals.size())});
}

Ending FindEnding(const AttemptTrace& trace) {
  if (trace.outcome.is_completed) return Ending::kCompleted;
  if (trace.is_operation) return Ending::kLeft;
  if (trace.outcome.phase.empty()) return Ending::kNoTask;
  if (trace.outcome.phase == "time_over") return Ending::kTimeOver;
  return trace.outcome.phase == "ended" ? Ending::kError : Ending::kLeft;
}

std::string DescribeOutcome(const AttemptTrace& trace) {
  const std::string played = FormatDuration(trace.Seconds());
  const std::string of_task = trace.outcome.task_time > 0 ? FormatDuration(trace.outcome.task_time) : played;
  const Ending ending = FindEnding(trace);
  if (trace.is_operation) {
    return ending == Ending::kCompleted
               ? host::TranslateWith("The operation was completed in {1}.", {played})
               : host::TranslateWith("The operation was not completed: it ended after {1}.", {played});
  }
  switch (ending) {
    case Ending::kCompleted:
      return host::TranslateWith("The task was completed in {1}.", {of_task});
    case Ending::kTimeOver:
      return host::TranslateWith("The time ran out after {1}{2}.", {of_task, CountGoals(trace)});
    case Ending::kError:
      return host::TranslateWith("An error ended the task after {1}{2}.", {of_task, CountGoals(trace)});
    case Ending::kNoTask:
      return host::TranslateWith("A scene without a task was played for {1}.", {played});
    case Ending::kLeft:
      break;
  }
  return host::TranslateWith("The task was not finished: it was left after {1}{2}.",
                             {of_task, CountGoals(trace)});
}

const MetricReference* FindReference(std::span<const MetricReference> references,
                                     const training::MetricValue& value) {
  for (const MetricReference& one : references) {
    if (one.metric == value.metric && one.hand == value.hand && one.phase == value.phase &&
        value.tool.empty())
      return &one;
  }
  return nullptr;
}

MetricRow MakeRow(const training::MetricValue& value, std::span<const MetricReference> references) {
  MetricRow row;
  row.id = value.metric, row.hand = value.hand, row.phase = value.phase, row.tool = value.tool;
  row.name = value.metric;
  if (const training::MetricDefinition* definition = training::FindMetric(value.metric)) {
    row.name = definition->name;
    row.about = definition->about;
    row.better = definition->better;
    row.evidence = definition->evidence;
    row.scale = definition->shown_scale;
    row.unit = !definition->shown_unit.empty() ? definition->shown_unit
               : definition->unit == "1"       ? ""
                                               : definition->unit;
  }
  row.value = row.scale * value.value;
  if (const MetricReference* reference = FindReference(references, value)) {
    if (reference->expert_mean) row.expert_mean = row.scale * *reference->expert_mean;
    if (reference->expert_deviation)
      row.expert_deviation = std::fabs(row.scale) * *reference->expert_deviation;
    for (const double one : reference->group) row.group.push_back(row.scale * one);
    std::sort(row.group.begin(), row.group.end());
    row.separates = reference->separates;
  }
  return row;
}

/// What a person reads of an event: its sentence, else its name as words.
std::string DescribeEvent(const training::AttemptEvent& event) {
  if (!event.text.empty()) return event.text;
  std::string words = event.kind;
  std::replace(words.begin(), words.end(), '_', ' ');
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z')
    words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

void AddErrors(const AttemptTrace& trace, AttemptReport& report) {
  for (const training::AttemptEvent& event : trace.events) {
    if (!event.is_error) continue;
    ErrorRow row{event.time, event.severity, event.hand, DescribeEvent(event), "", event.force};
    if (event.organ >= 0 && static_cast<std::size_t>(event.organ) < trace.organ_names.size()) {
      row.where = trace.organ_names[static_cast<std::size_t>(event.organ)];
      std::replace(row.where.begin(), row.where.end(), '_', ' ');
    }
    report.errors.push_back(std::move(row));
  }
}

/// Points that lie apart, and no more than a picture can show.
std::vector<Vec2> ThinPath(const std::vector<Vec2>& points) {
  std::vector<Vec2> kept;
  for (const Vec2& point : points) {
    if (kept.empty() || std::hypot(point.x - kept.back().x, point.y - kept.back().y) >= kPathStep)
      kept.push_back(point);
  }
  const std::size_t every = 1 + kept.size() / kMostPathPoints;
  if (every == 1) return kept;
  std::vector<Vec2> thin;
  for (std::size_t i = 0; i < kept.size(); i += every) thin.push_back(kept[i]);
  return thin;
}

HandSeries MakeSeries(const std::vector<training::ToolSample>& samples, double dt) {
  std::vector<Vec2> force, front, head;
  force.reserve(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const training::ToolSample& sample = samples[i];
    force.push_back({static_cast<double>(i) * dt, sample.force});
    front.push_back({kMillimetre * sample.tip.x, kMillimetre * sample.tip.y});
    head.push_back({kMillimetre * sample.tip.x, kMillimetre * sample.tip.z});
  }
  return {ThinOut(force, kMostForcePoints), ThinPath(front), ThinPath(head)};
}

}  // namespace

AttemptFacts DescribeAttempt(const record::Description& description, std::string task) {
  AttemptFacts facts;
  facts.task = std::move(task);
  facts.task_key = description.name;
  facts.level = description.level;
  // a folder of a user is nobody else's business
  facts.patient = description.patient.substr(description.patient.find_last_of('/') + 1);
  facts.task_key = facts.task_key.substr(facts.task_key.find_last_of('/') + 1);
  facts.seed = description.seed;
  facts.started = description.started;
  facts.player = description.player;
  facts.program = description.program;
  return facts;
}

const char* NameOf(Ending ending) noexcept {
  static constexpr std::array kNames{"completed", "time_over", "error", "left", "no_task"};
  return kNames[static_cast<std::size_t>(ending)];
}

AttemptReport MakeAttemptReport(const AttemptTrace& trace, const training::AttemptMetrics& metrics,
                                const AttemptReportInput& input) {
  AttemptReport report;
  report.facts = input.facts;
  report.ending = FindEnding(trace);
  report.outcome = DescribeOutcome(trace);
  report.is_completed = trace.outcome.is_completed;
  report.is_operation = trace.is_operation;
  report.score = trace.outcome.score;
  report.penalty = trace.outcome.penalty;
  report.seconds = trace.Seconds();
  if (trace.outcome.task_time > 0) report.task_seconds = trace.outcome.task_time;
  report.critical_view_time = trace.critical_view_time;
  if (trace.is_operation && !trace.fluids.empty()) {
    report.blood_ml = kMillilitre * trace.fluids.back().blood;
    report.bile_ml = kMillilitre * trace.fluids.back().bile;
  }
  for (const training::GoalRecord& goal : trace.goals) report.goals.push_back({goal.name, goal.time});
  AddErrors(trace, report);
  report.phases = trace.phases;
  for (const training::MetricValue& value : metrics.values)
    report.metrics.push_back(MakeRow(value, input.references));
  report.advice.assign(input.advice.begin(), input.advice.end());
  for (std::size_t hand = 0; hand < report.hands.size(); ++hand)
    report.hands[hand] = MakeSeries(trace.hands[hand], trace.dt);
  return report;
}

}  // namespace trocar::report
