// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/proficiency.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/host/text_table.h"

namespace trocar::assessment {
namespace {

using base::Error;
using base::ErrorCode;

constexpr double kExpertPercentile = 0.10, kNovicePercentile = 0.90;  // of composites, where grades begin [-]

/// Linear between the ordered values. \param share  0 to 1 \pre not empty
double CalcQuantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = base::TruncateTo<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

const double* Find(const training::AttemptMetrics& metrics, const MetricKey& key) {
  return metrics.Find(key.metric, key.hand, key.phase);
}

Norm MakeNorm(const MetricKey& of, Better better, const std::vector<double>& values) {
  Norm norm{of, better};
  const auto n = static_cast<double>(values.size());
  norm.attempts = values.size();
  norm.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - norm.mean) * (value - norm.mean);
  norm.deviation = values.size() > 1 ? std::sqrt(squares / (n - 1)) : 0.0;
  norm.best_quartile = CalcQuantile(values, better == Better::kLower ? 0.25 : 0.75);
  return norm;
}

std::vector<double> ValuesOf(std::span<const AttemptResult> attempts, const MetricKey& key) {
  std::vector<double> values;
  for (const AttemptResult& attempt : attempts) {
    if (const double* value = Find(attempt.metrics, key)) values.push_back(*value);
  }
  return values;
}

/// Of a set of experts: what the rule takes before slack, and its name.
std::pair<double, std::string> FindLevel(const Norm& norm, double novice_mean, LevelRule rule) {
  switch (rule) {
    case LevelRule::kMean:
      return {norm.mean, "mean"};
    case LevelRule::kBestQuartile:
      return {norm.best_quartile, "best quartile"};
    case LevelRule::kMidpoint:
      break;
  }
  return {0.5 * (norm.mean + novice_mean),
          "half way to the novices' mean of " + host::FormatNumber(novice_mean, 4)};
}

bool AreCounts(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == std::floor(value); });
}

/// Value and source of a threshold, of the values of experts and novices.
void SetLevel(const Norm& norm, const std::vector<double>& experts, const std::vector<double>& novices,
              const ExpertSetSettings& settings, Threshold& threshold) {
  const bool is_lower = norm.better == Better::kLower;
  const auto [least, most] = std::minmax_element(experts.begin(), experts.end());
  std::string rule = "worst";
  threshold.value = is_lower ? *most : *least;
  if (threshold.purpose != Purpose::kSafety) {
    const double novice_mean = novices.empty() ? norm.mean : MakeNorm(norm.of, norm.better, novices).mean;
    const auto [level, name] = FindLevel(norm, novice_mean, settings.rule);
    const double slack = settings.slack_deviations * norm.deviation;
    threshold.value = is_lower ? level + slack : level - slack;
    rule = name;
    // half an error more or less is none: the whole number that asks the same
    if (AreCounts(experts) && AreCounts(novices))
      threshold.value = is_lower ? std::floor(threshold.value) : std::ceil(threshold.value);
    if (slack > 0) rule += " and " + host::FormatNumber(settings.slack_deviations, 3) + " deviations";
  }
  threshold.source = rule + "; " + std::to_string(norm.attempts) + " attempts of experts: mean " +
                     host::FormatNumber(norm.mean, 4) + ", deviation " +
                     host::FormatNumber(norm.deviation, 3);
}

std::vector<double> Composites(const std::vector<Norm>& norms, std::span<const AttemptResult> attempts) {
  std::vector<double> composites;
  for (const AttemptResult& attempt : attempts) {
    if (const auto composite = CalcComposite(norms, attempt.metrics)) composites.push_back(*composite);
  }
  return composites;
}

}  // namespace

std::string_view NameOf(Purpose purpose) noexcept {
  constexpr std::string_view kNames[] = {"safety", "time", "economy", "quality"};
  return kNames[static_cast<std::size_t>(purpose)];
}

std::string TextOf(const MetricKey& key) {
  std::string text = key.metric;
  if (key.hand == "camera") {
    text += ", camera";
  } else if (!key.hand.empty()) {
    text += ", " + key.hand + " hand";
  }
  return key.phase.empty() ? text : text + ", in " + key.phase;
}

double CalcZScore(const Norm& norm, double value) {
  const double deviation = std::max(norm.deviation, kLeastDeviationShare * std::fabs(norm.mean));
  const double difference = norm.better == Better::kLower ? norm.mean - value : value - norm.mean;
  if (difference == 0) return 0;
  // of a set whose every number was 0, any other is as far away as can be
  if (deviation == 0) return std::copysign(kMostDeviations, difference);
  return std::clamp(difference / deviation, -kMostDeviations, kMostDeviations);
}

std::optional<double> CalcComposite(std::span<const Norm> norms, const training::AttemptMetrics& metrics) {
  double sum = 0;
  int count = 0;
  for (const Norm& norm : norms) {
    if (const double* value = Find(metrics, norm.of)) {
      sum += CalcZScore(norm, *value);
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

Verdict Judge(const Proficiency& proficiency, const AttemptResult& attempt) {
  Verdict verdict;
  verdict.is_completed = attempt.is_completed;
  verdict.is_safe = true;
  verdict.is_passed = attempt.is_completed;
  for (const Threshold& threshold : proficiency.thresholds) {
    ThresholdVerdict one;
    one.threshold = threshold;
    one.is_met = threshold.passes_undefined;
    if (const double* value = Find(attempt.metrics, threshold.of)) {
      one.value = *value;
      one.margin = threshold.better == Better::kLower ? threshold.value - *value : *value - threshold.value;
      one.is_met = one.margin >= 0;
    }
    if (!one.is_met) {
      verdict.is_passed = false;
      if (threshold.purpose == Purpose::kSafety) verdict.is_safe = false;
    } else if (!attempt.is_completed) {
      // whoever stops after one of twelve goals was not quick, and has made few errors for that reason alone
      one.is_met = false;
      one.is_open = true;
    }
    verdict.metrics.push_back(std::move(one));
  }
  verdict.composite = CalcComposite(proficiency.norms, attempt.metrics);
  if (verdict.composite && !proficiency.grades.empty()) {
    verdict.grade = proficiency.grades.back().name;
    for (const Grade& grade : proficiency.grades) {
      if (*verdict.composite < grade.at_least) continue;
      verdict.grade = grade.name;
      break;
    }
  }
  return verdict;
}

base::Result<Proficiency> MakeProficiency(std::span<const AttemptResult> experts,
                                          std::span<const AttemptResult> novices,
                                          const ExpertSetSettings& settings) {
  std::vector<AttemptResult> completed;
  for (const AttemptResult& expert : experts) {
    if (expert.is_completed) completed.push_back(expert);
  }
  if (completed.size() < kLeastExpertAttempts) {
    return Error{ErrorCode::kAttemptsTooFew,
                 std::to_string(completed.size()) + " of " + std::to_string(experts.size()) +
                     " attempts were completed, and levels need " + std::to_string(kLeastExpertAttempts) +
                     " by experts; record more"};
  }
  Proficiency result;
  result.task = settings.task;
  result.level = settings.level;
  result.source = settings.source;
  if (settings.rule == LevelRule::kMidpoint && novices.size() < kLeastExpertAttempts) {
    return Error{ErrorCode::kAttemptsTooFew,
                 "a level half way to novices needs " + std::to_string(kLeastExpertAttempts) +
                     " attempts of novices, and there are " + std::to_string(novices.size())};
  }
  for (const Threshold& wanted : settings.of) {
    const std::vector<double> values = ValuesOf(completed, wanted.of);
    if (values.size() < completed.size()) continue;
    const Norm norm = MakeNorm(wanted.of, wanted.better, values);
    Threshold threshold = wanted;
    SetLevel(norm, values, ValuesOf(novices, wanted.of), settings, threshold);
    result.norms.push_back(norm);
    result.thresholds.push_back(std::move(threshold));
  }
  if (result.thresholds.empty()) {
    return Error{ErrorCode::kProficiencyInvalid,
                 "none of the metrics that were asked for is defined in every attempt; ask for others"};
  }
  const auto expert_composites = Composites(result.norms, completed);
  const auto novice_composites = Composites(result.norms, novices);
  if (!novice_composites.empty()) {
    const double expert = CalcQuantile(expert_composites, kExpertPercentile);
    const double novice = CalcQuantile(novice_composites, kNovicePercentile);
    result.grades.push_back({"expert", expert});
    if (novice < expert) result.grades.push_back({"intermediate", 0.5 * (expert + novice)});
    result.grades.push_back({"novice", -kMostDeviations});
  }
  return result;
}

}  // namespace trocar::assessment
