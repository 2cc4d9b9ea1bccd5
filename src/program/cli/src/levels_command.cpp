// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "judgement_text.h"
#include "trocar/assessment/attempt.h"
#include "trocar/assessment/judge_recording.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/host/safe_file.h"
#include "trocar/training/metric_definition.h"

namespace trocar::cli {

using host::PrintLine;
using host::PrintLines;
using host::WrapText;

namespace {

using assessment::Attempt;
using assessment::Better;
using assessment::Purpose;
using assessment::Threshold;
using base::Error;
using base::ErrorCode;

/// What levels are made of where nobody says otherwise.
const std::vector<std::string> kOfTasks = {"safety:errors_critical",   "safety:errors_major",
                                           "quality:errors_minor",     "time:task_time",
                                           "economy:path_length:left", "economy:path_length:right"};
const std::vector<std::string> kOfOperations = {"safety:errors_critical",   "safety:errors_major",
                                                "safety:blood_lost",        "time:time",
                                                "economy:path_length:left", "economy:path_length:right"};

struct LevelsArguments {
  std::vector<std::string> experts, novices, metrics;
  std::string rule = "mean", source, output;
  double slack = 0;
  int threads = 1;
};

/// "PURPOSE:METRIC" or "PURPOSE:METRIC:HAND".
base::Result<Threshold> ParseMetric(const std::string& text) {
  const std::size_t first = text.find(':');
  const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  Threshold threshold;
  const std::string purpose = text.substr(0, first);
  bool is_purpose = false;
  for (const Purpose one : {Purpose::kSafety, Purpose::kTime, Purpose::kEconomy, Purpose::kQuality}) {
    if (purpose != NameOf(one)) continue;
    threshold.purpose = one;
    is_purpose = true;
  }
  if (first == std::string::npos || !is_purpose) {
    return Error{ErrorCode::kUsage,
                 "--metric is PURPOSE:METRIC or PURPOSE:METRIC:HAND, with safety, time, economy or "
                 "quality as purpose; not \"" +
                     text + "\""};
  }
  threshold.of.metric = text.substr(first + 1, second == std::string::npos ? second : second - first - 1);
  if (second != std::string::npos) threshold.of.hand = text.substr(second + 1);
  const training::MetricDefinition* definition = training::FindMetric(threshold.of.metric);
  if (definition == nullptr) {
    return Error{ErrorCode::kUnknownName,
                 "there is no metric \"" + threshold.of.metric + "\"; docs/metrics.md lists all"};
  }
  if (definition->better == training::BetterWhen::kNeither) {
    return Error{ErrorCode::kUsage,
                 "\"" + threshold.of.metric + "\" is neither better high nor low, so it can be no threshold"};
  }
  threshold.better = definition->better == training::BetterWhen::kLower ? Better::kLower : Better::kHigher;
  return threshold;
}

base::Result<std::vector<Attempt>> ReplayAll(const std::vector<std::string>& files, int threads,
                                             host::ProgressBar& bar, double& done) {
  std::vector<Attempt> attempts;
  for (const std::string& file : files) {
    auto recording = record::ReadRecording(file);
    if (!recording.ok()) return recording.error();
    assessment::ReplaySettings settings;
    settings.threads = threads;
    settings.progress = [&](double share) { return bar.Show(done + share), true; };
    auto attempt = assessment::MakeAttempt(std::move(*recording), settings);
    if (!attempt.ok()) return Error{attempt.error().code, file + ": " + attempt.error().message};
    attempts.push_back(std::move(*attempt));
    done += 1;
    const Attempt &first = attempts.front(), &last = attempts.back();
    if (first.task != last.task || first.level != last.level) {
      return Error{ErrorCode::kProficiencyInvalid, file + " is of " + last.task + " " + last.level +
                                                       ", and " + files.front() + " of " + first.task + " " +
                                                       first.level + "; take attempts at one task and level"};
    }
  }
  return attempts;
}

std::vector<assessment::AttemptResult> ResultsOf(const std::vector<Attempt>& attempts) {
  std::vector<assessment::AttemptResult> results;
  for (const Attempt& attempt : attempts) results.push_back(attempt.result);
  return results;
}

base::Status MakeLevels(const LevelsArguments& arguments) {
  host::ProgressBar bar("replaying",
                        static_cast<double>(arguments.experts.size() + arguments.novices.size()));
  double done = 0;
  const auto experts = ReplayAll(arguments.experts, arguments.threads, bar, done);
  if (!experts.ok()) return experts.error();
  const auto novices = ReplayAll(arguments.novices, arguments.threads, bar, done);
  if (!novices.ok()) return novices.error();
  bar.Finish();
  const Attempt& first = experts->front();
  if (!novices->empty() && (novices->front().task != first.task || novices->front().level != first.level)) {
    return Error{ErrorCode::kProficiencyInvalid,
                 "experts and novices did not do the same task at the same level"};
  }
  assessment::ExpertSetSettings settings;
  settings.task = first.task;
  settings.level = first.level;
  settings.rule = arguments.rule == "mean"       ? assessment::LevelRule::kMean
                  : arguments.rule == "midpoint" ? assessment::LevelRule::kMidpoint
                                                 : assessment::LevelRule::kBestQuartile;
  settings.slack_deviations = arguments.slack;
  settings.source = arguments.source;
  const auto& defaults = first.level.empty() ? kOfOperations : kOfTasks;
  for (const std::string& text : arguments.metrics.empty() ? defaults : arguments.metrics) {
    auto metric = ParseMetric(text);
    if (!metric.ok()) return metric.error();
    settings.of.push_back(std::move(*metric));
  }
  const auto made = assessment::MakeProficiency(ResultsOf(*experts), ResultsOf(*novices), settings);
  if (!made.ok()) return made.error();
  if (const auto written = host::WriteFile(arguments.output, FormatProficiency(*made)); !written.ok())
    return written;
  for (const Threshold& threshold : made->thresholds) PrintLine(DescribeThreshold(threshold));
  host::Say("{1} holds them; edit it, and name it in a course\n", arguments.output);
  return {};
}

base::Status ListLevels() {
  const auto all = assessment::ListProficiencies();
  if (!all.ok()) return all.error();
  std::vector<std::vector<std::string>> rows = {{"thresholds", "task", "level", "source"}};
  for (const auto& one : *all) {
    const std::string source = one.source.size() > 60 ? one.source.substr(0, 57) + "..." : one.source;
    rows.push_back({one.key, one.task, one.level.empty() ? "-" : one.level, source});
  }
  host::PrintTable(rows);
  return {};
}

base::Status ShowLevels(const std::string& name) {
  const auto one = assessment::FindProficiency(name);
  if (!one.ok()) return one.error();
  PrintLine(
      (one->level.empty() ? one->task : host::TranslateWith("{1}, level {2}", {one->task, one->level})));
  if (!one->about.empty()) PrintLines(WrapText(one->about, 100, ""));
  PrintLines(WrapText(host::TranslateWith("Source: {1}", {one->source}), 100, ""));
  for (const Threshold& threshold : one->thresholds) {
    PrintLine();
    PrintLine(DescribeThreshold(threshold));
    PrintLines(WrapText(threshold.source, 100, "  "));
  }
  for (const auto& grade : one->grades)
    host::Say(
        &grade == one->grades.data() ? "\n{1} from {2} deviations on\n" : "{1} from {2} deviations on\n",
        host::Translate(grade.name), host::ShownNumber(grade.at_least, 3));
  return {};
}

}  // namespace

void AddLevelsCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* levels = AddListed(app, "levels");
  levels->require_subcommand(1);
  CLI::App* list = levels->add_subcommand("list", "List the thresholds that are delivered");
  list->callback([&outcome] { outcome.status = ListLevels(); });
  CLI::App* show = levels->add_subcommand("show", "Print thresholds with the source of each");
  auto name = std::make_shared<std::string>();
  show->add_option("thresholds", *name, "Name of delivered ones, or a file")->required()->type_name("LEVELS");
  show->callback([=, &outcome] { outcome.status = ShowLevels(*name); });

  CLI::App* from =
      levels->add_subcommand("from", "Compute thresholds from recordings of experts, ten or more");
  auto a = std::make_shared<LevelsArguments>();
  from->add_option("recordings", a->experts, "Recordings of experts at one task and level")
      ->required()
      ->type_name("RECORDING");
  from->add_option("-o,--output", a->output, "File of thresholds to write")->required()->type_name("FILE");
  from->add_option("--source", a->source, "Who the experts were, in words that others understand")
      ->required()
      ->type_name("TEXT");
  from->add_option("--novices", a->novices,
                   "Recordings of novices: then there are grades between them and experts")
      ->type_name("RECORDING");
  from->add_option("--rule", a->rule,
                   "What the level is: of the experts, or half way between their mean and the novices'")
      ->check(CLI::IsMember({"mean", "best-quartile", "midpoint"}))
      ->capture_default_str();
  from->add_option("--slack", a->slack, "So many of their standard deviations easier; safety never")
      ->check(CLI::Range(0.0, 10.0))
      ->type_name("K")
      ->capture_default_str();
  from->add_option(
          "--metric", a->metrics,
          "What to ask for, in place of the usual: PURPOSE:METRIC[:HAND], as economy:path_length:left")
      ->type_name("METRIC");
  AddThreadsOption(*from, a->threads);
  from->footer(
      "Each recording is replayed. Of safety the worst completed attempt counts, of all else the mean or "
      "best quartile.\n"
      "Example: trocar levels from experts/*.trocar --source \"6 consultants, 2 attempts each\" -o "
      "our-peg-transfer.json");
  from->callback([a, &outcome] { outcome.status = MakeLevels(*a); });
  levels->footer("Example: trocar levels show peg_transfer-normal");
}

}  // namespace trocar::cli
