// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "trocar/agent/skill.h"
#include "trocar/bench/validity_statistics.h"
#include "trocar/bench/validity_study.h"
#include "trocar/training/metric_definition.h"

namespace trocar::bench {
namespace {

/// A number that fewer of the attempts have says nothing of the others.
constexpr double kDefinedShare = 0.9;
/// From this rank correlation on, two numbers say the same.
constexpr double kSame = 0.9;

using Name = std::pair<std::string, std::string>;  // metric, hand
using Values = std::map<std::string, std::vector<const StudyAttempt*>>;

std::string WordsOf(const Name& name) {
  return name.second.empty() ? name.first : name.first + ", " + name.second;
}

const double* Find(const StudyAttempt& attempt, const Name& name) {
  for (const StudyValue& value : attempt.values) {
    if (value.metric == name.first && value.hand == name.second) return &value.value;
  }
  return nullptr;
}

std::vector<double> Collect(const std::vector<const StudyAttempt*>& attempts, const Name& name) {
  std::vector<double> values;
  for (const StudyAttempt* attempt : attempts) {
    if (const double* value = Find(*attempt, name)) values.push_back(*value);
  }
  return values;
}

/// +1 where more is worse, -1 where less is, 0 where neither is.
int WorseSense(const std::string& metric) {
  if (metric.starts_with("coach:")) return 1;
  const training::MetricDefinition* definition = training::FindMetric(metric);
  if (definition == nullptr || definition->better == training::BetterWhen::kNeither) return 0;
  return definition->better == training::BetterWhen::kLower ? 1 : -1;
}

/// People by their attempts, those who have so many.
std::vector<std::vector<double>> TableOf(const std::vector<const StudyAttempt*>& attempts, const Name& name,
                                         int count, int StudyAttempt::*fixed) {
  std::map<int, std::vector<double>> people;
  for (const StudyAttempt* attempt : attempts) {
    if (attempt->*fixed != 0) continue;
    if (const double* value = Find(*attempt, name)) people[attempt->person].push_back(*value);
  }
  std::vector<std::vector<double>> table;
  for (auto& [person, values] : people) {
    if (static_cast<int>(values.size()) == count) table.push_back(std::move(values));
  }
  return table;
}

const std::string kNovice(agent::NameOf(agent::SkillLevel::kNovice)),
    kMiddle(agent::NameOf(agent::SkillLevel::kIntermediate)),
    kExpert(agent::NameOf(agent::SkillLevel::kExpert));

std::optional<MetricFinding> FindOut(Values& groups, const Name& name, const StudyOptions& options) {
  MetricFinding finding;
  finding.metric = name.first, finding.hand = name.second;
  const auto &novices = groups[kNovice], &middles = groups[kMiddle], &experts = groups[kExpert];
  const std::vector<double> low = Collect(novices, name), middle = Collect(middles, name),
                            high = Collect(experts, name);
  const auto enough = [](const auto& values, const auto& attempts) {
    return !attempts.empty() &&
           static_cast<double>(values.size()) >= kDefinedShare * static_cast<double>(attempts.size());
  };
  if (!enough(low, novices) || !enough(high, experts)) return std::nullopt;
  finding.novices = static_cast<int>(low.size()), finding.experts = static_cast<int>(high.size());
  const auto [low_least, low_most] = std::minmax_element(low.begin(), low.end());
  const auto [high_least, high_most] = std::minmax_element(high.begin(), high.end());
  finding.novice_low = *low_least, finding.novice_high = *low_most, finding.novice_mean = CalcMean(low);
  finding.expert_low = *high_least, finding.expert_high = *high_most, finding.expert_mean = CalcMean(high);
  finding.expert_sd = CalcDeviation(high);
  finding.middle_mean = CalcMean(middle);
  finding.is_ordered =
      !middle.empty() &&
      (finding.middle_mean - finding.novice_mean) * (finding.middle_mean - finding.expert_mean) < 0;
  const double more = CalcAuc(low, high);
  const int sense = WorseSense(name.first);
  finding.auc = sense > 0 ? more : sense < 0 ? 1 - more : std::max(more, 1 - more);
  const bool are_apart = AreApart(low, high);
  finding.separates = are_apart && finding.auc > 0.5;
  finding.is_reversed = are_apart && !finding.separates;
  finding.effect = CalcEffectSize(low, high);
  const auto table_of = [&](int count, int StudyAttempt::*fixed) {
    std::vector<std::vector<double>> table;
    for (const auto* level : {&novices, &middles, &experts}) {
      auto part = TableOf(*level, name, count, fixed);
      table.insert(table.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
    }
    return table;
  };
  const auto repeated = table_of(options.repeats, &StudyAttempt::patient);
  finding.icc = CalcIntraclassCorrelation(repeated);
  finding.alpha = CalcCronbachAlpha(repeated);
  if (options.patients > 1)
    finding.patient_icc = CalcIntraclassCorrelation(table_of(options.patients, &StudyAttempt::repeat));
  return finding;
}

std::vector<std::vector<std::string>> ClustersOf(Values& groups, const std::vector<Name>& names) {
  std::vector<Name> complete;
  std::vector<std::vector<double>> variables;
  for (const Name& name : names) {
    std::vector<double> values;
    std::size_t all = 0;
    for (const std::string& level : {kNovice, kMiddle, kExpert}) {
      const std::vector<double> part = Collect(groups[level], name);
      values.insert(values.end(), part.begin(), part.end());
      all += groups[level].size();
    }
    if (values.size() != all) continue;
    complete.push_back(name);
    variables.push_back(std::move(values));
  }
  std::vector<std::vector<std::string>> clusters;
  for (const auto& members : FindClusters(variables, kSame)) {
    clusters.emplace_back();
    for (const std::size_t i : members) clusters.back().push_back(WordsOf(complete[i]));
  }
  return clusters;
}

GroupFinding FindOutOfGroup(Values& groups, const std::string& group, const std::vector<Name>& names) {
  GroupFinding finding{group};
  for (const StudyAttempt* attempt : groups[group]) {
    ++finding.attempts;
    finding.completed += attempt->is_completed ? 1 : 0;
    finding.caught += attempt->is_caught ? 1 : 0;
  }
  for (const Name& name : names) {
    const std::vector<double> theirs = Collect(groups[group], name), able = Collect(groups[kExpert], name);
    if (theirs.empty() || able.empty()) continue;
    const double more = CalcAuc(theirs, able), side = std::max(more, 1 - more);
    if (side <= finding.best_auc) continue;
    finding.best_auc = side;
    finding.best_metric = WordsOf(name);
  }
  return finding;
}

}  // namespace

std::vector<TaskFindings> FindOutOfStudy(const StudyOptions& options,
                                         const std::vector<StudyAttempt>& attempts) {
  std::vector<TaskFindings> all;
  std::map<std::string, Values> tasks;
  for (const StudyAttempt& attempt : attempts) tasks[attempt.task][attempt.group].push_back(&attempt);
  for (auto& [task, groups] : tasks) {
    TaskFindings findings{task, options.level};
    findings.novices = static_cast<int>(groups[kNovice].size());
    findings.middles = static_cast<int>(groups[kMiddle].size());
    findings.experts = static_cast<int>(groups[kExpert].size());
    std::vector<Name> names;
    std::vector<std::string> others;
    for (const auto& [group, members] : groups) {
      findings.attempts += static_cast<int>(members.size());
      for (const StudyAttempt* attempt : members) {
        findings.completed += attempt->is_completed ? 1 : 0;
        for (const StudyValue& value : attempt->values) {
          const Name name{value.metric, value.hand};
          if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        }
      }
      if (group != kNovice && group != kMiddle && group != kExpert) others.push_back(group);
    }
    for (const Name& name : names) {
      if (auto finding = FindOut(groups, name, options)) {
        findings.metrics.push_back(std::move(*finding));
      } else {
        findings.left_out.push_back(WordsOf(name));
      }
    }
    std::stable_sort(findings.metrics.begin(), findings.metrics.end(),
                     [](const MetricFinding& a, const MetricFinding& b) {
                       return std::pair(a.separates, a.auc) > std::pair(b.separates, b.auc);
                     });
    findings.clusters = ClustersOf(groups, names);
    for (const std::string& group : others) findings.groups.push_back(FindOutOfGroup(groups, group, names));
    all.push_back(std::move(findings));
  }
  return all;
}

}  // namespace trocar::bench
