// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/coach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/host/json.h"
#include "trocar/training/coach_measures.h"

namespace trocar::training {
namespace {

constexpr std::string_view kCoach = "coach:", kEvent = "event:", kMetric = "metric:";
constexpr std::array<std::string_view, 9> kMeasures = {"tremor",        "one_hand_waits", "peak_force",
                                                       "energy_in_air", "tips_unseen",    "detour",
                                                       "corrections",   "pauses",         "time"};

/// Words in braces of a text.
std::vector<std::string> FindPlaceholders(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
    const std::size_t end = text.find('}', at);
    if (end == std::string::npos) break;
    found.push_back(text.substr(at + 1, end - at - 1));
  }
  return found;
}

void CheckWords(const host::JsonView& view, const char* key, const std::string& text, bool has_expert) {
  for (const std::string& word : FindPlaceholders(text)) {
    if (word == "value" || word == "most" || word == "times" || word == "hand" ||
        (word == "expert" && has_expert))
      continue;
    view.Complain(std::string(key) + " shows {" + word + "}, which is not known there");
  }
}

bool IsKnownMeasure(const std::string& measure) {
  const std::string_view text = measure;
  if (text.starts_with(kEvent)) return text.size() > kEvent.size();
  if (text.starts_with(kMetric)) return text.size() > kMetric.size();
  return text.starts_with(kCoach) &&
         std::find(kMeasures.begin(), kMeasures.end(), text.substr(kCoach.size())) != kMeasures.end();
}

CoachRule ReadRule(const host::JsonView& view) {
  view.AllowOnly({"id", "topic", "measure", "bad_when", "threshold_sd", "sd_floor", "least", "absolute",
                  "weight", "shown_scale", "decimals", "sentence", "sentence_alone", "why", "exercise",
                  "practise", "source"});
  CoachRule rule;
  rule.id = view.Text("id");
  rule.topic = view.Text("topic");
  rule.measure = view.Text("measure");
  if (!IsKnownMeasure(rule.measure)) view.Complain("\"" + rule.measure + "\" is no measure");
  const std::string bad = view.TextOr("bad_when", "higher");
  if (bad != "higher" && bad != "lower") view.Complain("bad_when is neither \"higher\" nor \"lower\"");
  rule.is_high_bad = bad == "higher";
  rule.threshold_sd = view.NumberOr("threshold_sd", rule.threshold_sd, {0, 1000});
  rule.sd_floor = view.NumberOr("sd_floor", 0, {0, 1e12});
  rule.least = view.NumberOr("least", rule.is_high_bad ? -1e300 : 1e300);
  if (view.Has("absolute")) rule.absolute = view.Number("absolute", {1e-12, 1e12});
  rule.weight = view.NumberOr("weight", 1, {0, 1000});
  rule.shown_scale = view.NumberOr("shown_scale", 1, {1e-9, 1e9});
  rule.decimals = view.IntegerOr("decimals", 1, {0, 6});
  rule.sentence = view.Text("sentence");
  rule.sentence_alone = view.TextOr("sentence_alone", "");
  rule.why = view.Text("why");
  rule.exercise = view.Text("exercise");
  rule.practise = view.Text("practise");
  rule.source = view.Text("source");
  CheckWords(view, "sentence", rule.sentence, true);
  CheckWords(view, "sentence_alone", rule.sentence_alone, false);
  if (rule.absolute && !rule.is_high_bad)
    view.Complain("an absolute threshold is one from which on it is too much");
  if (rule.absolute.has_value() == rule.sentence_alone.empty())
    view.Complain("absolute and sentence_alone go together");
  return rule;
}

struct Found {
  double value = 0;
  std::optional<CoachMoment> moment;
  std::optional<double> most;
};

/// What a rule asks for; nothing where it is not defined for the attempt.
std::optional<Found> FindMeasure(const std::string& measure, const AttemptTrace& trace,
                                 const AttemptMetrics& metrics, const std::vector<CoachMeasure>& measures) {
  const std::string_view text = measure;
  if (text.starts_with(kEvent)) {
    const CoachMeasure count = CountEvents(trace, measure.substr(kEvent.size()));
    return Found{count.value, count.moment, std::nullopt};
  }
  if (text.starts_with(kMetric)) {
    const std::string_view name = text.substr(kMetric.size());
    const std::size_t slash = name.find('/');
    const std::string_view hand = slash == std::string_view::npos ? "" : name.substr(slash + 1);
    const double* value = metrics.Find(name.substr(0, slash), hand);
    if (value == nullptr) return std::nullopt;
    return Found{*value, std::nullopt, std::nullopt};
  }
  for (const CoachMeasure& one : measures) {
    if (text.substr(kCoach.size()) == one.name) return Found{one.value, one.moment, one.most};
  }
  return std::nullopt;
}

/// The expert set's line for a rule.
const MeasureValidity* FindReference(const std::string& measure, const TaskValidity* reference) {
  if (reference == nullptr) return nullptr;
  const std::string_view text = measure;
  if (!text.starts_with(kMetric)) return reference->Find(text);
  const std::string_view name = text.substr(kMetric.size());
  const std::size_t slash = name.find('/');
  return reference->Find(name.substr(0, slash),
                         slash == std::string_view::npos ? "" : name.substr(slash + 1));
}

std::optional<AdviceNumbers> Weigh(const CoachRule& rule, double value, const MeasureValidity* expert) {
  AdviceNumbers numbers;
  numbers.value = value;
  const double sense = rule.is_high_bad ? 1 : -1;
  if (sense * (value - rule.least) <= 0) return std::nullopt;
  if (expert != nullptr) {
    numbers.expert_mean = expert->expert_mean;
    numbers.expert_sd = expert->expert_sd;
    const double sd = std::max({expert->expert_sd, rule.sd_floor, 1e-12});
    numbers.deviation = sense * (value - expert->expert_mean) / sd;
    numbers.threshold = rule.threshold_sd;
  } else if (rule.absolute) {
    numbers.deviation = value / *rule.absolute;
    numbers.threshold = 1;
  } else {
    return std::nullopt;
  }
  if (!(numbers.deviation >= numbers.threshold)) return std::nullopt;
  numbers.cost = rule.weight * numbers.deviation;
  return numbers;
}

std::string Fill(std::string text, std::string_view word, const std::string& with) {
  const std::string placeholder = "{" + std::string(word) + "}";
  for (std::size_t at = text.find(placeholder); at != std::string::npos;
       at = text.find(placeholder, at + with.size()))
    text.replace(at, placeholder.size(), with);
  return text;
}

std::string Number(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

/// "once", "twice", "3 times"
std::string Times(double count) {
  const std::string number = Number(count, 0);
  return number == "1" ? "once" : number == "2" ? "twice" : number + " times";
}

std::string HandWords(int hand) {
  return hand == instrument::kLeft    ? "the left hand"
         : hand == instrument::kRight ? "the right hand"
                                      : "both hands";
}

Advice Speak(const CoachRule& rule, const AdviceNumbers& numbers, const std::optional<CoachMoment>& moment) {
  Advice advice;
  advice.rule = rule.id;
  advice.topic = rule.topic;
  advice.why = rule.why;
  advice.exercise = rule.exercise;
  advice.practise = rule.practise;
  advice.source = rule.source;
  advice.numbers = numbers;
  advice.sentence = numbers.expert_mean ? rule.sentence : rule.sentence_alone;
  advice.sentence = Fill(advice.sentence, "times", Times(numbers.value));
  advice.sentence = Fill(advice.sentence, "most",
                         Number(rule.shown_scale * numbers.most.value_or(numbers.value), rule.decimals));
  advice.sentence = Fill(advice.sentence, "value", Number(rule.shown_scale * numbers.value, rule.decimals));
  if (numbers.expert_mean)
    advice.sentence =
        Fill(advice.sentence, "expert", Number(rule.shown_scale * *numbers.expert_mean, rule.decimals));
  advice.sentence = Fill(advice.sentence, "hand", HandWords(moment ? moment->hand : -1));
  if (moment) {
    advice.time = moment->time;
    advice.hand = moment->hand;
    advice.look = "Look at " + FormatMoment(moment->time);
    if (moment->seconds >= 1) advice.look += ", for " + Number(moment->seconds, 0) + " s";
    if (moment->hand >= 0) advice.look += ": " + HandWords(moment->hand);
    advice.look += ".";
  }
  return advice;
}

}  // namespace

base::Result<CoachRules> ParseCoachRules(std::string_view text, const std::string& name) {
  auto document = host::JsonDocument::Parse(text, name);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "most", "rules"});
  if (root.Text("format") != "trocar-coach-rules") root.Complain("the format is not \"trocar-coach-rules\"");
  if (root.Integer("version") != 1) root.Complain("the version is not 1");
  CoachRules rules;
  rules.most = root.IntegerOr("most", rules.most, {1, 10});
  for (const host::JsonView& view : root.Array("rules")) {
    CoachRule rule = ReadRule(view);
    const bool is_twice = std::any_of(rules.rules.begin(), rules.rules.end(),
                                      [&](const CoachRule& other) { return other.id == rule.id; });
    if (is_twice) view.Complain("there is another rule \"" + rule.id + "\"");
    rules.rules.push_back(std::move(rule));
  }
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return rules;
}

std::vector<Advice> CoachAttempt(const AttemptTrace& trace, const AttemptMetrics& metrics,
                                 const CoachRules& rules, const TaskValidity* reference) {
  const std::vector<CoachMeasure> measures = CalcCoachMeasures(trace);
  std::vector<Advice> all;
  for (const CoachRule& rule : rules.rules) {
    const auto found = FindMeasure(rule.measure, trace, metrics, measures);
    if (!found) continue;
    auto numbers = Weigh(rule, found->value, FindReference(rule.measure, reference));
    if (!numbers) continue;
    numbers->most = found->most;
    all.push_back(Speak(rule, *numbers, found->moment));
  }
  // what costs as much keeps the order of the rules
  std::stable_sort(all.begin(), all.end(),
                   [](const Advice& a, const Advice& b) { return a.numbers.cost > b.numbers.cost; });
  std::vector<Advice> chosen;
  for (Advice& advice : all) {
    const bool is_said = std::any_of(chosen.begin(), chosen.end(),
                                     [&](const Advice& other) { return other.topic == advice.topic; });
    if (is_said) continue;
    chosen.push_back(std::move(advice));
    if (chosen.size() == static_cast<std::size_t>(rules.most)) break;
  }
  return chosen;
}

std::string FormatMoment(double seconds) {
  const auto whole = base::FloorTo<long long>(std::max(0.0, seconds));
  char text[32];
  std::snprintf(text, sizeof text, "%lld:%02lld", whole / 60, whole % 60);
  return text;
}

}  // namespace trocar::training
