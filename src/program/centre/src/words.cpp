// SPDX-License-Identifier: Apache-2.0
#include "words.h"

#include <cstdio>

#include "trocar/centre/judged_attempt.h"
#include "trocar/files/task_file.h"
#include "trocar/host/translate.h"
#include "trocar/report/attempt_report.h"
#include "trocar/scene/scene.h"
#include "trocar/training/metric_definition.h"

namespace trocar::centre {

std::string MetricName(const assessment::MetricKey& key) {
  const training::MetricDefinition* definition = training::FindMetric(key.metric);
  std::string name = definition == nullptr ? key.metric : host::Translate(definition->name);
  if (!key.hand.empty()) name += ", " + report::HandName(key.hand);
  if (!key.phase.empty()) name += ", " + report::PhaseName(key.phase);
  return name;
}

std::string MetricText(const std::string& metric, double value) {
  const training::MetricDefinition* definition = training::FindMetric(metric);
  if (definition == nullptr) return report::FormatShown(value);
  std::string unit = definition->shown_unit;
  if (unit.empty() && definition->unit != "1") unit = definition->unit;
  return report::FormatShown(definition->shown_scale * value) + (unit.empty() ? "" : " " + unit);
}

std::string LimitText(const assessment::Threshold& threshold) {
  return (threshold.better == assessment::Better::kLower ? host::Translate("at most ")
                                                         : host::Translate("at least ")) +
         MetricText(threshold.of.metric, threshold.value);
}

std::string ThresholdText(const assessment::Threshold& threshold) {
  return MetricName(threshold.of) + ": " + LimitText(threshold);
}

std::string ScoreText(double score, bool is_percent) {
  char text[48];
  std::snprintf(text, sizeof text, "%.1f", score);
  const std::string number = host::LocalNumber(text);
  return is_percent ? number + " %" : host::TranslateWith("{1} points", {number});
}

const std::string& TaskBook::NameOf(const std::string& task) {
  const auto found = names_.find(task);
  return found != names_.end() ? found->second : names_.emplace(task, TaskNameOf(task)).first->second;
}

bool TaskBook::IsScorePercent(const std::string& task, const std::string& level) {
  const std::pair key(task, level);
  if (const auto found = is_percent_.find(key); found != is_percent_.end()) return found->second;
  bool is_percent = false;
  if (const auto path = files::FindTask(task); path.ok()) {
    const auto scene = files::ReadTask(*path, {level.empty() ? "normal" : level, 1, {}});
    is_percent = scene.ok() && scene->task && scene->task->reference_points > 0;
  }
  return is_percent_[key] = is_percent;
}

}  // namespace trocar::centre
