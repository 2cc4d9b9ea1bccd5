// SPDX-License-Identifier: Apache-2.0
/// \file coach_command.cpp  `trocar coach`: what cost most in a recorded attempt, and what to practise.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/record/trace.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach.h"
#include "trocar/training/metric_definition.h"
#include "trocar/training/validity.h"
#include "validity_note.h"

namespace trocar::cli {

using host::Say;
using host::TranslateComposed;

namespace {

using nlohmann::ordered_json;

struct CoachArguments {
  std::string file, rules, validity;
  int threads = 1;
  bool is_json = false;
};

ordered_json OrNull(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json ToJson(const training::Advice& advice) {
  ordered_json json = {{"rule", advice.rule},
                       {"topic", advice.topic},
                       {"sentence", advice.sentence},
                       {"look", advice.look},
                       {"why", advice.why},
                       {"exercise", advice.exercise},
                       {"practise", advice.practise},
                       {"source", advice.source},
                       {"time_s", OrNull(advice.time)},
                       {"hand", nullptr},
                       {"value", advice.numbers.value},
                       {"most", OrNull(advice.numbers.most)},
                       {"expert_mean", OrNull(advice.numbers.expert_mean)},
                       {"expert_sd", OrNull(advice.numbers.expert_sd)},
                       {"deviation", advice.numbers.deviation},
                       {"threshold", advice.numbers.threshold},
                       {"cost", advice.numbers.cost}};
  if (advice.hand >= 0) json["hand"] = advice.hand == instrument::kLeft ? "left" : "right";
  return json;
}

base::Status Coach(const CoachArguments& arguments) {
  const auto rules = ReadCoachRules(arguments.rules);
  if (!rules.ok()) return rules.error();
  const auto validity = ReadValidity(arguments.validity);
  if (!validity.ok()) return validity.error();
  auto recording = record::ReadRecording(arguments.file);
  if (!recording.ok()) return recording.error();
  const std::string task = TaskKey(recording->description.name);
  host::ProgressBar progress("replaying", 1.0);
  const auto trace = record::TraceRecording(std::move(*recording), arguments.threads,
                                            [&](double share) { progress.Show(share); });
  progress.Finish();
  if (!trace.ok()) return trace.error();
  const auto metrics = training::CalcAttemptMetrics(*trace);
  if (!metrics.ok()) return metrics.error();
  const training::TaskValidity* reference = validity->FindTask(task);
  const auto advice = training::CoachAttempt(*trace, *metrics, *rules, reference);
  if (arguments.is_json) {
    ordered_json list = ordered_json::array();
    for (const training::Advice& one : advice) list.push_back(ToJson(one));
    const ordered_json json = {{"task", task},
                               {"expert_set", reference != nullptr},
                               {"advice", std::move(list)},
                               {"disclaimer", std::string(training::MetricsDisclaimer())}};
    PrintJson(json);
    return {};
  }
  if (advice.empty()) Say("Nothing stands out against what the coach knows of this task.\n");
  for (std::size_t i = 0; i < advice.size(); ++i) {
    const training::Advice& one = advice[i];
    host::PrintLine(std::to_string(i + 1) + ". " + TranslateComposed(one.sentence) +
                    (one.look.empty() ? "" : " " + TranslateComposed(one.look)));
    Say("   Why: {1}\n   Practise: {2} (trocar play expert --task {3} shows it)\n",
        TranslateComposed(one.why), TranslateComposed(one.practise), one.exercise);
    Say("   Rule {1}: {2} {3}, threshold {4}.\n", one.rule, host::ShownNumber(one.numbers.deviation, 3),
        one.numbers.expert_mean ? host::Translate("standard deviations beyond scripted experts")
                                : host::Translate("times what is let pass"),
        host::ShownNumber(one.numbers.threshold, 3));
  }
  if (reference == nullptr)
    Say("No expert set is known for \"{1}\": only absolute rules were asked.\n", task);
  Say("Training feedback, not certified assessment.\n");
  return {};
}

}  // namespace

void AddCoachCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "coach");
  auto a = std::make_shared<CoachArguments>();
  command->add_option("file", a->file, "Recording")->required()->type_name("FILE");
  command->add_option("--rules", a->rules, "Rules in place of assets/coach/rules.json")->type_name("FILE");
  command
      ->add_option("--validity", a->validity,
                   "Expert sets in place of assets/validity.json, as trocar study writes them")
      ->type_name("FILE");
  AddThreadsOption(*command, a->threads, "Of the solver; the words are the same for any number");
  AddJsonFlag(*command, a->is_json, "Machine-readable, with every rule's numbers");
  command->footer(
      "Every sentence comes from one rule and its numbers; none is a judgement of competence.\n"
      "Example: trocar play wanders --task peg_transfer --record attempt.trocar && trocar coach "
      "attempt.trocar");
  command->callback([a, &outcome] { outcome.status = Coach(*a); });
}

}  // namespace trocar::cli
