// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "disclaimer.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"
#include "trocar/report/attempt_report.h"
#include "trocar/report/charts.h"
#include "trocar/training/metric_definition.h"

namespace trocar::report {
namespace {

using surgery::Severity;
using training::BetterWhen;

// what stands on the first pages; the last section has everything
constexpr std::array<std::string_view, 16> kMainOfHands = {
    "path_length",   "movements",          "mean_speed",           "sparc",
    "idle_fraction", "depth_path",         "out_of_view_fraction", "grasp_efficiency",
    "grasp_slips",   "max_force",          "force_exceedances",    "hard_contacts",
    "cautery_time",  "cautery_efficiency", "safe_cautery",         "clips_placed"};
constexpr std::array<std::string_view, 8> kMainOfAttempt = {
    "time",       "bimanual_fraction", "instrument_collisions", "errors",
    "blood_lost", "bile_spilled",      "stones_lost",           "goals_done_fraction"};
constexpr const char* kDash = "–";
constexpr const char* kHands[] = {"left", "right"};

Tone ToneOf(Severity severity) {
  return severity == Severity::kMinor   ? Tone::kPlain
         : severity == Severity::kMajor ? Tone::kCaution
                                        : Tone::kBad;
}

const MetricRow* FindRow(const AttemptReport& report, std::string_view id, std::string_view hand,
                         std::string_view phase = "") {
  for (const MetricRow& row : report.metrics) {
    if (row.id == id && row.hand == hand && row.phase == phase && row.tool.empty()) return &row;
  }
  return nullptr;
}

std::string ValueText(const MetricRow* row) {
  return row == nullptr ? kDash : FormatShown(row->value);
}

std::string BetterText(BetterWhen better) {
  return better == BetterWhen::kHigher  ? host::Translate("more")
         : better == BetterWhen::kLower ? host::Translate("less")
                                        : "";
}

std::string ExpertText(const MetricRow& row) {
  if (!row.expert_mean) return kDash;
  std::string text = FormatShown(*row.expert_mean);
  if (row.expert_deviation) text += " ± " + FormatShown(*row.expert_deviation);
  return text;
}

std::string NameText(const MetricRow& row) {
  return host::Translate(row.name) + (row.separates == false ? " †" : "");
}

/// Better or worse than most experts: two standard deviations.
Tone CompareWithExperts(const MetricRow* row) {
  if (row == nullptr || !row->expert_mean || !row->expert_deviation || row->better == BetterWhen::kNeither)
    return Tone::kPlain;
  const double sign = row->better == BetterWhen::kLower ? 1 : -1;
  return sign * (row->value - *row->expert_mean) > 2 * *row->expert_deviation ? Tone::kCaution : Tone::kPlain;
}

// --- summary

Tiles::Tile ScoreTile(const AttemptReport& report) {
  if (!report.is_completed)
    return {host::Translate("Score"), host::Translate("No score"),
            host::Translate("the task was not completed"), Tone::kCaution};
  return {host::Translate("Score"), FormatDigits(*report.score, 3) + (report.facts.best_score ? " %" : ""),
          report.facts.best_score ? host::TranslateWith("an able surgeon gets {1} % at this level",
                                                        {FormatDigits(*report.facts.best_score, 3)})
                                  : host::Translate("points of the task"),
          Tone::kPlain};
}

Tiles::Tile ErrorTile(const AttemptReport& report) {
  std::array<std::size_t, 3> counts{};
  for (const ErrorRow& error : report.errors) ++counts[static_cast<std::size_t>(error.severity)];
  const auto [minor, major, critical] = counts;
  std::string note =
      host::TranslateWith("{1} critical, {2} major, {3} minor",
                          {std::to_string(critical), std::to_string(major), std::to_string(minor)});
  const Tone tone = critical > 0                                   ? Tone::kBad
                    : major > 0                                    ? Tone::kCaution
                    : report.errors.empty() && report.is_completed ? Tone::kGood
                                                                   : Tone::kPlain;
  if (report.errors.empty() && !report.is_completed) note = host::Translate("in what was done");
  if (report.errors.empty() && report.is_completed) note = host::Translate("none was seen");
  return {host::Translate("Errors"), std::to_string(report.errors.size()), note, tone};
}

Section MakeSummary(const AttemptReport& report) {
  Section section{host::Translate("Result"), {}};
  section.blocks.emplace_back(Paragraph{report.outcome, report.is_completed ? Tone::kGood : Tone::kCaution});
  if (report.facts.is_as_recorded == false) {
    section.blocks.emplace_back(Paragraph{
        host::Translate("The file of this recording claims another outcome. This report is of what was "
                        "computed from its inputs; the claim is refused."),
        Tone::kBad});
  }
  Tiles tiles;
  tiles.tiles.push_back({host::Translate("Time"),
                         FormatClock(std::round(report.task_seconds.value_or(report.seconds))),
                         report.task_seconds ? host::Translate("from the first movement")
                                             : host::Translate("minutes and seconds"),
                         Tone::kPlain});
  if (report.score) tiles.tiles.push_back(ScoreTile(report));
  tiles.tiles.push_back(ErrorTile(report));
  if (report.is_operation) {
    tiles.tiles.push_back(
        report.critical_view_time
            ? Tiles::Tile{host::Translate("Critical view of safety"), host::Translate("achieved"),
                          host::TranslateWith("after {1}",
                                              {FormatClock(std::round(*report.critical_view_time))}),
                          Tone::kGood}
            : Tiles::Tile{host::Translate("Critical view of safety"), host::Translate("not achieved"), "",
                          Tone::kBad});
  }
  if (report.blood_ml) {
    tiles.tiles.push_back({host::Translate("Blood lost"), FormatShown(*report.blood_ml) + " mL",
                           host::TranslateWith("bile {1} mL", {FormatShown(report.bile_ml.value_or(0))}),
                           *report.blood_ml > 50 ? Tone::kCaution : Tone::kPlain});
  }
  if (!report.goals.empty()) {
    const auto done = std::count_if(report.goals.begin(), report.goals.end(),
                                    [](const GoalRow& goal) { return goal.time.has_value(); });
    const bool is_all = static_cast<std::size_t>(done) == report.goals.size();
    tiles.tiles.push_back(
        {host::Translate("Goals"),
         host::TranslateWith("{1} of {2}", {std::to_string(done), std::to_string(report.goals.size())}), "",
         is_all ? Tone::kGood : Tone::kCaution});
  }
  section.blocks.emplace_back(std::move(tiles));
  section.blocks.emplace_back(Paragraph{DisclaimerSentence(), Tone::kMuted});
  return section;
}

Section MakeAdviceSection(const AttemptReport& report) {
  Section section{host::Translate("What to work on"), {}};
  Advices advices;
  for (const Advice& advice : report.advice) {
    advices.items.push_back(
        {host::TranslateComposed(advice.sentence),
         advice.time ? host::TranslateWith("Look at {1}", {FormatClock(std::round(*advice.time))}) : "",
         host::Translate(advice.why),
         host::Translate(advice.practise.empty() ? advice.exercise : advice.practise)});
  }
  section.blocks.emplace_back(std::move(advices));
  return section;
}

// --- what happened

Section MakeCourse(const AttemptReport& report) {
  Section section{host::Translate("What happened when"), {}};
  section.blocks.emplace_back(Figures{{DrawTimeline(report)}});
  if (!report.errors.empty()) {
    Table table{host::Translate("Errors in the order in which they happened"),
                {{host::Translate("Time"), true, 0.5},
                 {host::Translate("Severity"), false, 0.7},
                 {host::Translate("What happened"), false, 3.4},
                 {host::Translate("By"), false, 0.8},
                 {host::Translate("Where"), false, 1.1}},
                {}};
    for (const ErrorRow& error : report.errors) {
      table.rows.push_back({{FormatClock(std::round(error.time))},
                            {host::Translate(surgery::NameOf(error.severity)), ToneOf(error.severity)},
                            {host::TranslateComposed(error.what)},
                            {error.hand == 0 || error.hand == 1 ? HandName(kHands[error.hand]) : kDash},
                            {error.where.empty() ? kDash : host::TranslateComposed(error.where)}});
    }
    section.blocks.emplace_back(std::move(table));
  }
  if (!report.goals.empty()) {
    Table table{host::Translate("Goals of the task"),
                {{host::Translate("Goal"), false, 4}, {host::Translate("Reached"), true, 1}},
                {}};
    for (const GoalRow& goal : report.goals) {
      table.rows.push_back(
          {{host::TranslateComposed(goal.name)},
           {goal.time ? host::TranslateWith("after {1}", {FormatClock(std::round(*goal.time))})
                      : host::Translate("not reached"),
            goal.time ? Tone::kPlain : Tone::kCaution}});
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

/// A phase may come again: its stretches are added up.
Table MakePhaseTable(const AttemptReport& report) {
  Table table{host::Translate("Each phase"),
              {{host::Translate("Phase"), false, 3.2},
               {host::Translate("Time"), true, 0.8},
               {host::Translate("Share"), true, 0.8},
               {host::Translate("Errors"), true, 0.8},
               {host::Translate("Path left"), true, 1},
               {host::Translate("Path right"), true, 1},
               {host::Translate("Greatest force"), true, 1.2}},
              {}};
  std::vector<std::string> names;
  std::map<std::string, double> seconds;
  for (const training::PhaseSpan& span : report.phases) {
    if (seconds.find(span.name) == seconds.end()) names.push_back(span.name);
    seconds[span.name] += span.end - span.start;
  }
  for (const std::string& name : names) {
    std::size_t errors = 0;
    for (const ErrorRow& error : report.errors) {
      for (const training::PhaseSpan& span : report.phases)
        errors += span.name == name && error.time >= span.start && error.time < span.end ? 1 : 0;
    }
    const MetricRow *left = FindRow(report, "path_length", "left", name),
                    *right = FindRow(report, "path_length", "right", name);
    const auto path = [](const MetricRow* row) {
      return row == nullptr ? std::string(kDash) : FormatShown(row->value) + " " + row->unit;
    };
    double force = -1;
    for (const char* hand : kHands) {
      if (const MetricRow* row = FindRow(report, "max_force", hand, name))
        force = std::max(force, row->value);
    }
    table.rows.push_back(
        {{PhaseName(name)},
         {FormatClock(std::round(seconds[name]))},
         {FormatDigits(std::round(100 * seconds[name] / std::max(report.seconds, 1e-9)), 3) + " %"},
         {std::to_string(errors), errors > 0 ? Tone::kCaution : Tone::kPlain},
         {path(left)},
         {path(right)},
         {force < 0 ? kDash : FormatShown(force) + " N"}});
  }
  return table;
}

// --- numbers

Table MakeHandTable(const AttemptReport& report) {
  Table table{host::Translate("Each hand"),
              {{host::Translate("Measure"), false, 2.6},
               {host::Translate("Left"), true, 0.9},
               {host::Translate("Right"), true, 0.9},
               {host::Translate("Unit"), false, 0.7},
               {host::Translate("Better"), false, 0.7},
               {host::Translate("Experts, left"), true, 1.2},
               {host::Translate("Experts, right"), true, 1.2}},
              {}};
  bool has_experts = false;
  for (const std::string_view id : kMainOfHands) {
    const MetricRow *left = FindRow(report, id, "left"), *right = FindRow(report, id, "right");
    const MetricRow* any = left != nullptr ? left : right;
    if (any == nullptr) continue;
    // what neither hand had to do with (current without an electrode) says nothing here
    const bool is_idle = (left == nullptr || left->value == 0) && (right == nullptr || right->value == 0);
    if (is_idle && (id == "cautery_time" || id == "clips_placed")) continue;
    has_experts = has_experts || any->expert_mean;
    table.rows.push_back({{NameText(*any)},
                          {ValueText(left), CompareWithExperts(left)},
                          {ValueText(right), CompareWithExperts(right)},
                          {any->unit},
                          {BetterText(any->better)},
                          {left != nullptr ? ExpertText(*left) : kDash},
                          {right != nullptr ? ExpertText(*right) : kDash}});
  }
  if (!has_experts) {
    table.columns.resize(5);
    for (auto& row : table.rows) row.resize(5);
  }
  return table;
}

Table MakeAttemptTable(const AttemptReport& report) {
  Table table{host::Translate("The whole attempt"),
              {{host::Translate("Measure"), false, 2.6},
               {host::Translate("Value"), true, 0.9},
               {host::Translate("Unit"), false, 0.7},
               {host::Translate("Better"), false, 0.7},
               {host::Translate("Experts"), true, 1.2}},
              {}};
  bool has_experts = false;
  for (const std::string_view id : kMainOfAttempt) {
    const MetricRow* row = FindRow(report, id, "");
    if (row == nullptr) continue;
    has_experts = has_experts || row->expert_mean;
    table.rows.push_back({{NameText(*row)},
                          {ValueText(row), CompareWithExperts(row)},
                          {row->unit},
                          {BetterText(row->better)},
                          {ExpertText(*row)}});
  }
  if (!has_experts) {
    table.columns.resize(4);
    for (auto& row : table.rows) row.resize(4);
  }
  return table;
}

std::string DescribeGroup(const GroupFacts& group, bool has_radar) {
  const std::string name = host::TranslateWith("Group \"{1}\"", {group.name});
  if (!group.why_not.empty())
    return host::TranslateWith("{1} is left out: {2}.", {name, host::TranslateComposed(group.why_not)});
  if (!has_radar)
    return host::TranslateWith(
        "{1} is left out: there is no expert set of this task, by whose spread it is drawn.", {name});
  return host::TranslateWith(
      "{1}: {2} people who have completed this task at this level, each by the latest attempt.",
      {name, std::to_string(group.people)});
}

Section MakeHands(const AttemptReport& report) {
  Section section{host::Translate("How the hands worked"), {}};
  Figures figures{{DrawPaths(report, PathView::kFromFront), DrawPaths(report, PathView::kFromHead)}};
  auto radar = DrawRadar(report);
  const bool has_radar = radar.has_value();
  if (has_radar) figures.drawings.push_back(std::move(*radar));
  section.blocks.emplace_back(std::move(figures));
  if (report.group)
    section.blocks.emplace_back(Paragraph{DescribeGroup(*report.group, has_radar), Tone::kMuted});
  section.blocks.emplace_back(MakeHandTable(report));
  section.blocks.emplace_back(MakeAttemptTable(report));
  const bool has_mark = std::any_of(report.metrics.begin(), report.metrics.end(),
                                    [](const MetricRow& row) { return row.separates == false; });
  if (has_mark)
    section.blocks.emplace_back(
        Paragraph{host::Translate("† This measure does not tell scripted novices from scripted experts."),
                  Tone::kMuted});
  return section;
}

/// Everything, with what it is.
Section MakeAllMeasures(const AttemptReport& report) {
  Section section{host::Translate("All measures"), {}};
  Table table{host::Translate("Of the whole attempt; a dash where a measure has no meaning here"),
              {{host::Translate("Measure"), false, 1.9},
               {host::Translate("Left"), true, 0.75},
               {host::Translate("Right"), true, 0.75},
               {host::Translate("Laparoscope"), true, 1.05},
               {host::Translate("Whole"), true, 0.75},
               {host::Translate("Unit"), false, 0.65},
               {host::Translate("What it is"), false, 3.0},
               {host::Translate("Evidence"), false, 1.1}},
              {}};
  for (const training::MetricDefinition& definition : training::MetricDefinitions()) {
    const std::array<const MetricRow*, 4> cells = {
        FindRow(report, definition.id, "left"), FindRow(report, definition.id, "right"),
        FindRow(report, definition.id, "camera"), FindRow(report, definition.id, "")};
    const auto any =
        std::find_if(cells.begin(), cells.end(), [](const MetricRow* row) { return row != nullptr; });
    if (any == cells.end()) continue;
    table.rows.push_back({{NameText(**any)},
                          {ValueText(cells[0])},
                          {ValueText(cells[1])},
                          {ValueText(cells[2])},
                          {ValueText(cells[3])},
                          {(*any)->unit},
                          {host::Translate((*any)->about), Tone::kMuted},
                          {host::Translate(NameOf((*any)->evidence)), Tone::kMuted}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section MakeOrigin(const AttemptReport& report) {
  const AttemptFacts& facts = report.facts;
  Section section{host::Translate("Where this comes from"), {}};
  Facts rows;
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) rows.rows.emplace_back(name, value);
  };
  add(host::Translate("Key of the task"), facts.task_key);
  add(host::Translate("Seed"), std::to_string(facts.seed));
  add(host::Translate("Played by"), host::TranslateComposed(facts.player));
  add(host::Translate("Recording"), facts.recording);
  add(host::Translate("Program"), facts.program.empty() ? "" : "Trocar " + facts.program);
  for (const auto& [name, value] : report.origin) add(host::Translate(name), value);
  section.blocks.emplace_back(std::move(rows));
  return section;
}

}  // namespace

Document MakeDocument(const AttemptReport& report) {
  const AttemptFacts& facts = report.facts;
  Document document;
  document.title = facts.task.empty() ? host::Translate("Attempt") : host::Translate(facts.task);
  document.subtitle = report.is_operation ? host::Translate("Report of an operation")
                                          : host::Translate("Report of an attempt");
  document.date = facts.started;
  const auto head = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) document.head.emplace_back(name, value);
  };
  head(host::Translate("Trainee"), facts.person);
  head(host::Translate("Date"), FormatDate(facts.started));
  head(host::Translate("Level"), host::Translate(facts.level));
  head(host::Translate("Patient"), facts.patient);
  document.sections.push_back(MakeSummary(report));
  if (!report.advice.empty()) document.sections.push_back(MakeAdviceSection(report));
  document.sections.push_back(MakeCourse(report));
  if (!report.phases.empty())
    document.sections.push_back({host::Translate("Phases of the operation"), {MakePhaseTable(report)}});
  if (report.doublet) {
    document.sections.push_back(
        {host::Translate("Critical view of safety"),
         {Paragraph{host::TranslateComposed(report.doublet->verdict), Tone::kPlain},
          Pictures{{{report.doublet->front_png,
                     host::TranslateWith("From the front, at {1}",
                                         {FormatClock(std::round(report.doublet->front_time))})},
                    {report.doublet->back_png,
                     host::TranslateWith("From behind, at {1}",
                                         {FormatClock(std::round(report.doublet->back_time))})}}}}});
  }
  if (!report.pictures.empty() || !report.film.empty()) {
    Section seen{host::Translate("What was seen"), {}};
    if (!report.film.empty()) seen.blocks.emplace_back(Film{report.film});
    if (!report.pictures.empty()) seen.blocks.emplace_back(Pictures{report.pictures});
    document.sections.push_back(std::move(seen));
  }
  document.sections.push_back(MakeHands(report));
  document.sections.push_back(MakeAllMeasures(report));
  document.sections.push_back(MakeOrigin(report));
  document.footer = FooterText(facts.person, facts.program);
  return document;
}

}  // namespace trocar::report
