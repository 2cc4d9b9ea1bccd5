// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/trainee_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "disclaimer.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"
#include "trocar/report/charts.h"

namespace trocar::report {
namespace {

constexpr std::size_t kFewestOfACurve = 2;
constexpr std::size_t kMostPractise = 5;
constexpr const char* kDash = "–";

/// "Object transport, hard"
std::string TaskText(const std::string& task, const std::string& level) {
  return level.empty() ? host::Translate(task) : host::Translate(task) + ", " + host::Translate(level);
}

std::string ShortOutcome(const AttemptReport& report) {
  return report.is_completed ? host::Translate("completed") : host::Translate("not completed");
}

/// Fewer critical errors first, then the better score or the shorter time.
bool IsBetter(const AttemptRow& a, const AttemptRow& b) {
  if (a.is_completed != b.is_completed) return a.is_completed;
  if (a.critical_errors != b.critical_errors) return a.critical_errors < b.critical_errors;
  if (a.score && b.score && *a.score != *b.score) return *a.score > *b.score;
  return a.seconds < b.seconds;
}

void AddCurves(const std::vector<AttemptReport>& reports, TraineeReport& trainee) {
  std::vector<std::string> tasks;
  std::map<std::string, std::vector<const AttemptReport*>> of_task;
  for (const AttemptReport& report : reports) {
    // how long an attempt took that was given up says nothing of learning
    if (!report.is_completed) continue;
    const std::string task = TaskText(report.facts.task, report.facts.level);
    if (of_task.find(task) == of_task.end()) tasks.push_back(task);
    of_task[task].push_back(&report);
  }
  for (const std::string& task : tasks) {
    const auto& attempts = of_task[task];
    if (attempts.size() < kFewestOfACurve) continue;
    LearningCurve time{task, host::Translate("Time"), "s", {}, {}, {}},
        score{task,
              host::Translate("Score"),
              attempts[0]->facts.best_score ? "%" : host::Translate("points"),
              {},
              {},
              {}};
    for (const AttemptReport* attempt : attempts) {
      time.values.push_back(attempt->seconds);
      if (attempt->score) score.values.push_back(*attempt->score);
    }
    trainee.curves.push_back(std::move(time));
    if (score.values.size() == attempts.size()) trainee.curves.push_back(std::move(score));
  }
}

void AddPractise(const std::vector<AttemptReport>& reports, TraineeReport& trainee) {
  for (const AttemptReport& report : reports) {
    for (const Advice& advice : report.advice) {
      const std::string practise = advice.practise.empty() ? advice.exercise : advice.practise;
      const auto known = std::find_if(trainee.practise.begin(), trainee.practise.end(),
                                      [&](const PractisePoint& point) { return point.practise == practise; });
      if (known != trainee.practise.end()) {
        ++known->attempts;
        known->sentence = advice.sentence;  // the newest numbers
      } else {
        trainee.practise.push_back({advice.sentence, practise, 1});
      }
    }
  }
  std::stable_sort(trainee.practise.begin(), trainee.practise.end(),
                   [](const PractisePoint& a, const PractisePoint& b) { return a.attempts > b.attempts; });
  if (trainee.practise.size() > kMostPractise) trainee.practise.resize(kMostPractise);
}

Cell PassCell(const AttemptRow& row) {
  if (!row.is_passed) return {kDash, Tone::kMuted};
  return *row.is_passed ? Cell{host::Translate("passed"), Tone::kGood}
                        : Cell{host::Translate("not passed"), Tone::kCaution};
}

Table MakeAttemptTable(const TraineeReport& report) {
  Table table{host::Translate("In order of time"),
              {{host::Translate("Date"), false, 1.7},
               {host::Translate("Task"), false, 2},
               {host::Translate("Patient"), false, 1},
               {host::Translate("Time"), true, 0.7},
               {host::Translate("Score"), true, 0.7},
               {host::Translate("Critical errors"), true, 0.9},
               {host::Translate("All errors"), true, 0.8},
               {host::Translate("Outcome"), false, 1.1},
               {host::Translate("Thresholds"), false, 1}},
              {}};
  for (const AttemptRow& row : report.attempts) {
    table.rows.push_back(
        {{FormatDate(row.started)},
         {TaskText(row.task, row.level)},
         {row.patient.empty() ? kDash : row.patient},
         {FormatClock(std::round(row.seconds))},
         {row.score && row.is_completed ? FormatDigits(*row.score, 3) : kDash},
         {std::to_string(row.critical_errors), row.critical_errors > 0 ? Tone::kBad : Tone::kPlain},
         {std::to_string(row.errors)},
         {row.outcome, row.is_completed ? Tone::kPlain : Tone::kCaution},
         PassCell(row)});
  }
  return table;
}

Table MakeBestTable(const TraineeReport& report) {
  Table table{host::Translate(
                  "The best attempt of each task: completed, fewest critical errors, then score and time"),
              {{host::Translate("Task"), false, 2.4},
               {host::Translate("Attempts"), true, 0.9},
               {host::Translate("Completed"), true, 0.9},
               {host::Translate("Best time"), true, 0.9},
               {host::Translate("Best score"), true, 0.9},
               {host::Translate("When"), false, 1.8}},
              {}};
  std::vector<std::string> tasks;
  std::map<std::string, std::vector<const AttemptRow*>> of_task;
  for (const AttemptRow& row : report.attempts) {
    const std::string task = TaskText(row.task, row.level);
    if (of_task.find(task) == of_task.end()) tasks.push_back(task);
    of_task[task].push_back(&row);
  }
  for (const std::string& task : tasks) {
    const auto& rows = of_task[task];
    const AttemptRow* best = *std::min_element(
        rows.begin(), rows.end(), [](const AttemptRow* a, const AttemptRow* b) { return IsBetter(*a, *b); });
    const auto completed =
        std::count_if(rows.begin(), rows.end(), [](const AttemptRow* row) { return row->is_completed; });
    const bool is_any = best->is_completed;
    table.rows.push_back({{task},
                          {std::to_string(rows.size())},
                          {std::to_string(completed)},
                          {is_any ? FormatClock(std::round(best->seconds)) : kDash},
                          {is_any && best->score ? FormatDigits(*best->score, 3) : kDash},
                          {is_any ? FormatDate(best->started) : kDash}});
  }
  return table;
}

Section MakeSummary(const TraineeReport& report) {
  Section section{host::Translate("Summary"), {}};
  Tiles tiles;
  const auto completed = std::count_if(report.attempts.begin(), report.attempts.end(),
                                       [](const AttemptRow& row) { return row.is_completed; });
  double seconds = 0;
  std::size_t critical = 0;
  for (const AttemptRow& row : report.attempts) seconds += row.seconds, critical += row.critical_errors;
  tiles.tiles.push_back({host::Translate("Attempts"), std::to_string(report.attempts.size()),
                         host::TranslateWith("{1} completed", {std::to_string(completed)}), Tone::kPlain});
  tiles.tiles.push_back(
      {host::Translate("Time at the simulator"), FormatDuration(seconds), "", Tone::kPlain});
  tiles.tiles.push_back({host::Translate("Critical errors"), std::to_string(critical),
                         host::Translate("in all attempts"), critical > 0 ? Tone::kBad : Tone::kPlain});
  section.blocks.emplace_back(std::move(tiles));
  section.blocks.emplace_back(Paragraph{DisclaimerSentence(), Tone::kMuted});
  return section;
}

}  // namespace

TraineeReport MakeTraineeReport(const std::vector<AttemptReport>& reports) {
  TraineeReport trainee;
  for (const AttemptReport& report : reports) {
    AttemptRow row{report.facts.started,
                   report.facts.task,
                   report.facts.level,
                   report.facts.patient,
                   ShortOutcome(report),
                   report.is_completed,
                   {},
                   report.score,
                   report.seconds,
                   0,
                   report.errors.size()};
    row.critical_errors = static_cast<std::size_t>(
        std::count_if(report.errors.begin(), report.errors.end(),
                      [](const ErrorRow& error) { return error.severity == surgery::Severity::kCritical; }));
    trainee.attempts.push_back(std::move(row));
  }
  if (!reports.empty()) {
    trainee.person = reports.front().facts.person;
    trainee.program = reports.back().facts.program;
    trainee.from = reports.front().facts.started;
    trainee.until = reports.back().facts.started;
  }
  AddCurves(reports, trainee);
  AddPractise(reports, trainee);
  return trainee;
}

Document MakeDocument(const TraineeReport& report) {
  Document document;
  document.title = report.person.empty() ? host::Translate("Trainee")
                                         : host::TranslateWith("Trainee {1}", {report.person});
  document.subtitle = host::Translate("Report of a trainee");
  document.date = report.until;
  document.head = {{host::Translate("From"), FormatDate(report.from)},
                   {host::Translate("Until"), FormatDate(report.until)}};
  document.sections.push_back(MakeSummary(report));
  if (!report.practise.empty()) {
    Advices advices;
    for (const PractisePoint& point : report.practise) {
      advices.items.push_back({host::TranslateComposed(point.sentence),
                               host::TranslateCount("in {1} attempt", "in {1} attempts",
                                                    static_cast<std::size_t>(point.attempts)),
                               "", host::Translate(point.practise)});
    }
    document.sections.push_back({host::Translate("What to practise"), {std::move(advices)}});
  }
  if (!report.curves.empty()) {
    Figures figures;
    for (const LearningCurve& curve : report.curves) figures.drawings.push_back(DrawLearningCurve(curve));
    document.sections.push_back(
        {host::Translate("Learning curves"),
         {std::move(figures), Paragraph{host::Translate("Completed attempts only."), Tone::kMuted}}});
  }
  if (!report.cusums.empty()) {
    Section section{host::Translate("Failures over time (CUSUM)"), {}};
    Figures figures;
    for (const CusumChart& chart : report.cusums) figures.drawings.push_back(DrawCusum(chart));
    section.blocks.emplace_back(std::move(figures));
    for (const CusumChart& chart : report.cusums)
      section.blocks.emplace_back(Paragraph{chart.task + ": " + chart.verdict, Tone::kPlain});
    document.sections.push_back(std::move(section));
  }
  document.sections.push_back({host::Translate("Best attempts"), {MakeBestTable(report)}});
  document.sections.push_back({host::Translate("All attempts"), {MakeAttemptTable(report)}});
  document.footer = FooterText(report.person, report.program);
  return document;
}

}  // namespace trocar::report
