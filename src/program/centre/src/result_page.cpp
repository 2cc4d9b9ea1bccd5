// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/result_page.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/record/recording.h"
#include "trocar/report/charts.h"
#include "trocar/report/report_files.h"
#include "trocar/store/attempts.h"
#include "trocar/training/metric_definition.h"
#include "words.h"

namespace trocar::centre {
namespace {

using report::MetricRow;
using training::BetterWhen;

constexpr double kRangeDeviations = 2;  // of the expert set, that a person is shown as its range

/// Passed or not, in words; only what is complete can be good.
void SetVerdict(const JudgedAttempt& judged, ResultPage& page) {
  const bool is_completed = judged.attempt.is_completed;
  if (judged.report.facts.task_key.empty() ||
      (!judged.report.is_operation && !judged.report.score && !judged.verdict)) {
    page.verdict = host::Translate("Nothing is judged in this scene");
    return;
  }
  if (!is_completed) {
    page.verdict = host::Translate("Not completed");
    page.tone = Tone::kCaution;
    return;
  }
  if (!judged.verdict) {
    page.verdict = host::Translate("Completed; there are no thresholds for this task");
    return;
  }
  if (judged.verdict->is_passed) {
    page.verdict = host::Translate("Passed");
    page.tone = Tone::kGood;
    return;
  }
  const auto missed =
      static_cast<std::size_t>(std::count_if(judged.verdict->metrics.begin(), judged.verdict->metrics.end(),
                                             [](const auto& m) { return !m.is_met && !m.is_open; }));
  page.verdict = host::TranslateWith(
      "Completed, not passed: {1} of {2} missed",
      {std::to_string(missed),
       host::TranslateCount("{1} threshold", "{1} thresholds", judged.verdict->metrics.size())});
  page.tone = judged.verdict->is_safe ? Tone::kCaution : Tone::kBad;
}

/// What made the score what it is: goals, time and errors.
std::string WhyOfScore(const report::AttemptReport& r) {
  std::vector<std::string> parts;
  const auto done = static_cast<std::size_t>(std::count_if(
      r.goals.begin(), r.goals.end(), [](const report::GoalRow& goal) { return goal.time.has_value(); }));
  if (!r.goals.empty())
    parts.push_back(
        host::TranslateWith("{1} of {2} goals", {std::to_string(done), std::to_string(r.goals.size())}));
  if (!r.is_completed) {
    parts.push_back(host::Translate("not finished: no points for time"));
  } else if (r.task_seconds) {
    parts.push_back(host::TranslateWith("in {1}", {report::FormatClock(*r.task_seconds)}));
  }
  if (r.penalty > 0)
    parts.push_back(
        host::TranslateWith("errors took {1} off", {ScoreText(r.penalty, r.facts.best_score.has_value())}));
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// What to do better first: the worst error, or else what the coach puts first, or else what is unfinished.
void FindFirst(const JudgedAttempt& judged, ResultPage& page) {
  const auto worst = std::max_element(
      page.errors.begin(), page.errors.end(),
      [](const ResultPage::ErrorRow& a, const ResultPage::ErrorRow& b) { return a.tone < b.tone; });
  const bool has_errors = worst != page.errors.end();
  if (has_errors && (worst->tone == Tone::kBad || page.advice.empty())) {
    page.first = worst->what, page.first_time = worst->time;
    return;
  }
  if (!page.advice.empty()) {
    page.first = page.advice.front().sentence, page.first_time = page.advice.front().time;
    return;
  }
  if (judged.attempt.is_completed) return;
  for (const report::GoalRow& goal : judged.report.goals) {
    if (goal.time) continue;
    page.first = host::TranslateWith("Finish: {1}", {host::TranslateComposed(goal.name)});
    return;
  }
}

void AddTiles(const JudgedAttempt& judged, ResultPage& page) {
  const report::AttemptReport& r = judged.report;
  if (r.score)
    page.tiles.push_back(
        {host::Translate("Score"), ScoreText(*r.score, r.facts.best_score.has_value()), WhyOfScore(r)});
  page.tiles.push_back(
      {host::Translate("Time"), report::FormatClock(report::ShownSeconds(r)), host::Translate("min:s")});
  const auto critical = std::count_if(r.errors.begin(), r.errors.end(), [](const report::ErrorRow& error) {
    return error.severity == surgery::Severity::kCritical;
  });
  page.tiles.push_back({host::Translate("Errors"), std::to_string(r.errors.size()),
                        critical > 0 ? host::TranslateWith("{1} critical", {std::to_string(critical)}) : ""});
  if (!r.goals.empty()) {
    const auto done = std::count_if(r.goals.begin(), r.goals.end(),
                                    [](const report::GoalRow& goal) { return goal.time.has_value(); });
    page.tiles.push_back(
        {host::Translate("Goals"),
         host::TranslateWith("{1} of {2}", {std::to_string(done), std::to_string(r.goals.size())}), ""});
  }
  if (r.blood_ml)
    page.tiles.push_back({host::Translate("Blood"), report::FormatShown(*r.blood_ml) + " mL", ""});
  if (r.is_operation) {
    page.tiles.push_back(
        {host::Translate("Critical view"),
         r.critical_view_time ? report::FormatClock(*r.critical_view_time) : host::Translate("not achieved"),
         r.critical_view_time ? host::Translate("achieved at, min:s") : ""});
  }
}

void AddErrors(const report::AttemptReport& from, ResultPage& page) {
  for (const report::ErrorRow& error : from.errors) {
    ResultPage::ErrorRow row;
    row.time = error.time;
    row.clock = report::FormatClock(error.time);
    row.what = host::TranslateComposed(error.what);
    if (!error.where.empty()) row.what += " (" + host::TranslateComposed(error.where) + ")";
    if (error.force > 0) row.what += " (" + report::FormatShown(error.force) + " N)";
    if (error.hand >= 0)
      row.what += error.hand == 0 ? host::Translate(", left hand") : host::Translate(", right hand");
    row.severity = host::Translate(surgery::NameOf(error.severity));
    row.tone = error.severity == surgery::Severity::kMinor   ? Tone::kPlain
               : error.severity == surgery::Severity::kMajor ? Tone::kCaution
                                                             : Tone::kBad;
    page.errors.push_back(std::move(row));
  }
}

bool IsOutside(const MetricRow& row) {
  if (!row.expert_mean || !row.expert_deviation || row.better == BetterWhen::kNeither) return false;
  const double limit = kRangeDeviations * *row.expert_deviation;
  return row.better == BetterWhen::kLower ? row.value > *row.expert_mean + limit
                                          : row.value < *row.expert_mean - limit;
}

std::string RangeText(const MetricRow& row) {
  if (!row.expert_mean || !row.expert_deviation) return "";
  const double low = *row.expert_mean - kRangeDeviations * *row.expert_deviation;
  const double high = *row.expert_mean + kRangeDeviations * *row.expert_deviation;
  const bool is_never_negative = *row.expert_mean >= 0;
  return report::FormatShown(is_never_negative ? std::max(0.0, low) : low) + " – " +
         report::FormatShown(high);
}

/// A person's best in a metric, in the unit that is shown.
std::string BestText(Desk& desk, const JudgedAttempt& judged, const MetricRow& row) {
  if (row.better == BetterWhen::kNeither || judged.attempt.trainee.empty()) return "";
  store::MetricKey key;
  key.task = judged.attempt.task, key.level = judged.attempt.level;
  key.metric = row.id, key.hand = row.hand;
  const auto standing = store::FindStanding(desk.store, desk.viewer, judged.attempt.trainee, key);
  if (!standing.ok() || !*standing) return "";
  const double best = row.better == BetterWhen::kLower ? (*standing)->lowest : (*standing)->highest;
  return report::FormatShown(row.scale * best);
}

void AddMetrics(const JudgedAttempt& judged, const Access* access, ResultPage& page) {
  std::optional<Desk> desk;
  if (access != nullptr && !judged.attempt.trainee.empty()) {
    if (auto opened = OpenDesk(*access); opened.ok()) desk = std::move(*opened);
  }
  for (const MetricRow& row : judged.report.metrics) {
    if (!row.phase.empty() || !row.tool.empty()) continue;
    ResultPage::MetricRow shown;
    shown.name = host::Translate(row.name) + (row.hand.empty() ? "" : ", " + report::HandName(row.hand));
    shown.about = host::Translate(row.about);
    if (row.separates && !*row.separates)
      shown.about +=
          "\n" +
          host::Translate("It does not tell scripted novices from experts in this task (docs/validity.md).");
    shown.about += "\n" + host::TranslateWith("Evidence: {1}.", {host::Translate(NameOf(row.evidence))});
    shown.value = report::FormatShown(row.value) + (row.unit.empty() ? "" : " " + row.unit);
    shown.expert = RangeText(row);
    shown.is_outside = IsOutside(row);
    if (desk) shown.best = BestText(*desk, judged, row);
    page.metrics.push_back(std::move(shown));
  }
}

}  // namespace

ResultPage MakeResultPage(const JudgedAttempt& judged, const Access* access) {
  const report::AttemptReport& r = judged.report;
  ResultPage page;
  page.title =
      host::Translate(r.facts.task) + (r.facts.level.empty() ? "" : ", " + host::Translate(r.facts.level));
  page.subtitle = report::FormatDate(r.facts.started) + "  ·  " + host::TranslateComposed(r.facts.player);
  if (access != nullptr) page.subtitle += "  ·  " + NameOf(*access, judged.attempt.trainee);
  if (judged.is_demonstration)
    page.subtitle += host::Translate("  ·  a demonstration, which is nobody's attempt and is not stored");
  SetVerdict(judged, page);
  if (const std::string mark = store::DescribeMark(judged.attempt.mark); !mark.empty()) {
    page.verdict = judged.attempt.mark.state == store::Verification::kRefused
                       ? host::Translate(mark)
                       : host::TranslateWith("{1}; {2}", {page.verdict, host::Translate(mark)});
    page.tone = judged.attempt.mark.state == store::Verification::kRefused ? Tone::kBad : Tone::kCaution;
  }
  page.outcome = r.outcome;
  page.debriefing = host::Translate(judged.debriefing);
  AddTiles(judged, page);
  if (judged.verdict) {
    for (const assessment::ThresholdVerdict& one : judged.verdict->metrics) {
      page.thresholds.push_back(
          {MetricName(one.threshold.of),
           one.value ? MetricText(one.threshold.of.metric, *one.value) : host::Translate("not measured"),
           LimitText(one.threshold), one.threshold.source, one.is_met, one.is_open});
    }
  }
  for (const report::Advice& advice : r.advice)
    page.advice.push_back({host::TranslateComposed(advice.sentence), host::Translate(advice.why),
                           host::Translate(advice.practise), advice.exercise, advice.time});
  AddErrors(r, page);
  FindFirst(judged, page);
  AddMetrics(judged, access, page);
  page.drawings = {report::DrawTimeline(r), report::DrawPaths(r, report::PathView::kFromFront),
                   report::DrawPaths(r, report::PathView::kFromHead)};
  if (auto radar = report::DrawRadar(r); radar) page.drawings.push_back(std::move(*radar));
  page.recording = judged.attempt.recording;
  page.begin = judged.begin;
  page.report = r;
  page.step = judged.step;
  return page;
}

base::Status SaveReport(const report::AttemptReport& report, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".html") return host::WriteFile(path, report::FormatHtml(report::MakeDocument(report)));
  if (ending == ".pdf") return host::WriteFile(path, report::FormatPdf(report::MakeDocument(report)));
  if (ending == ".csv") return host::WriteFile(path, report::FormatCsv(report));
  if (ending == ".json") return host::WriteFile(path, report::FormatJson(report));
  return base::Error{base::ErrorCode::kUsage,
                     "a report is saved as .html, .pdf, .csv or .json; give the file one of these endings"};
}

// what people add

namespace {

/// The attempt's number in the store, 0 where it is not there.
base::Result<std::int64_t> FindStored(Desk& desk, const store::Attempt& attempt) {
  store::AttemptFilter filter;
  filter.trainee = attempt.trainee;
  filter.task = attempt.task;
  constexpr int kMost = 1000;
  std::string from;
  do {
    const auto page = store::ListAttempts(desk.store, desk.viewer, filter, from, kMost);
    if (!page.ok()) return page.error();
    for (const store::StoredAttempt& one : page->attempts) {
      if (one.attempt.recording_id == attempt.recording_id && one.attempt.started == attempt.started)
        return one.id;
    }
    from = page->next;
  } while (!from.empty());
  return std::int64_t{0};
}

/// As its recording says; where that is away, as every delivered scene has it.
double TickSecondsOf(const store::Attempt& attempt) {
  const auto recording = record::ReadRecording(attempt.recording);
  return recording.ok() ? recording->description.tick_seconds : 1.0 / 120;
}

}  // namespace

base::Result<ReviewPage> LoadReview(const Access& access, const store::Attempt& attempt) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  ReviewPage page;
  const auto id = FindStored(*desk, attempt);
  if (!id.ok()) return id.error();
  page.attempt = *id;
  page.may_review = desk->viewer.role != store::Role::kTrainee;
  for (const std::string& key : report::ListRatingForms()) {
    const auto form = report::FindRatingForm(key);
    if (!form.ok()) return form.error();
    ReviewPage::Form shown{form->key, form->name, host::Translate(form->about), {}};
    for (const report::RatingItem& item : form->items)
      shown.items.push_back({item.key, host::Translate(item.name), host::Translate(item.lowest),
                             host::Translate(item.highest), 0});
    page.forms.push_back(std::move(shown));
  }
  if (page.attempt == 0) return page;
  const auto remarks = store::ListRemarks(desk->store, desk->viewer, page.attempt);
  if (!remarks.ok()) return remarks.error();
  const double tick_seconds = TickSecondsOf(attempt);
  for (const store::Remark& one : *remarks) {
    const double time = static_cast<double>(one.tick) * tick_seconds;
    page.remarks.push_back({report::FormatClock(time), one.text, NameOf(access, one.author), time});
  }
  const auto ratings = store::ListRatings(desk->store, desk->viewer, page.attempt);
  if (!ratings.ok()) return ratings.error();
  for (const store::Rating& rating : *ratings) {
    if (rating.rater != access.person) continue;
    for (ReviewPage::Form& form : page.forms) {
      for (ReviewPage::Item& item : form.items) {
        if (form.name == rating.form && item.key == rating.item) item.points = rating.value;
      }
    }
  }
  return page;
}

base::Status KeepRemark(const Access& access, const ReviewPage& page, double time, const std::string& text) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  const auto stored = store::FindAttempt(desk->store, desk->viewer, page.attempt);
  if (!stored.ok()) return stored.error();
  const double tick_seconds = TickSecondsOf(stored->attempt);
  return store::AddRemark(desk->store, desk->viewer, page.attempt, std::llround(time / tick_seconds), text);
}

base::Status KeepRating(const Access& access, const ReviewPage& page, const ReviewPage::Form& form) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  for (const ReviewPage::Item& item : form.items) {
    if (item.points == 0) continue;
    const auto kept = store::AddRating(desk->store, desk->viewer, page.attempt,
                                       {form.name, item.key, item.points, access.person});
    if (!kept.ok()) return kept;
  }
  return {};
}

}  // namespace trocar::centre
