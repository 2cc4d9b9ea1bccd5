// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/history_page.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "trocar/assessment/learning.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/files/task_file.h"
#include "trocar/host/translate.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/report/charts.h"
#include "trocar/scene/scene.h"
#include "trocar/store/attempts.h"
#include "words.h"

namespace trocar::centre {
namespace {

constexpr int kRows = 20;         // of a page
constexpr int kMostCurve = 1000;  // attempts of which a curve is drawn: the newest

HistoryPage::Row MakeRow(const Access& access, TaskBook& tasks, const store::StoredAttempt& stored) {
  const store::Attempt& attempt = stored.attempt;
  HistoryPage::Row row;
  row.id = stored.id;
  row.when = report::FormatDate(attempt.started);
  row.task =
      tasks.NameOf(attempt.task) + (attempt.level.empty() ? "" : ", " + host::Translate(attempt.level));
  row.person = NameOf(access, attempt.trainee);
  if (!attempt.is_completed) {
    row.outcome = host::Translate("not completed");
    row.tone = Tone::kCaution;
  } else if (attempt.is_passed) {
    row.outcome = *attempt.is_passed ? host::Translate("passed") : host::Translate("not passed");
    row.tone = *attempt.is_passed ? Tone::kGood : Tone::kCaution;
  } else {
    row.outcome = host::Translate("completed");
  }
  if (const std::string mark = store::DescribeMark(attempt.mark); !mark.empty()) {
    row.mark = host::Translate(mark);
    row.outcome = attempt.mark.state == store::Verification::kRefused
                      ? row.mark
                      : host::TranslateWith("{1}; {2}", {row.outcome, row.mark});
    row.tone = attempt.mark.state == store::Verification::kRefused ? Tone::kBad : Tone::kCaution;
  }
  if (attempt.score && attempt.is_completed)
    row.score = ScoreText(*attempt.score, tasks.IsScorePercent(attempt.task, attempt.level));
  row.time = report::FormatClock(attempt.seconds);
  std::error_code failure;
  if (!attempt.recording.empty() && std::filesystem::exists(attempt.recording, failure))
    row.recording = attempt.recording;
  row.attempt = attempt;
  return row;
}

/// A task's attempts of one level, the oldest first.
base::Result<std::vector<store::Attempt>> ListOfTask(Desk& desk, const HistoryQuery& query,
                                                     std::string& level, std::size_t& left_out) {
  store::AttemptFilter filter;
  filter.trainee = query.person;
  filter.task = query.task;
  const auto page = store::ListAttempts(desk.store, desk.viewer, filter, {}, kMostCurve);
  if (!page.ok()) return page.error();
  std::vector<store::Attempt> attempts;
  if (!page->attempts.empty()) level = page->attempts.front().attempt.level;
  for (const store::StoredAttempt& one : page->attempts) {
    if (one.attempt.level != level) continue;
    if (one.attempt.mark.Counts())
      attempts.push_back(one.attempt);
    else
      ++left_out;
  }
  std::reverse(attempts.begin(), attempts.end());
  return attempts;
}

void AddCurve(const std::vector<double>& seconds, const std::string& task, HistoryPage& page) {
  if (seconds.empty()) return;
  report::LearningCurve curve;
  curve.task = task;
  curve.measure = host::Translate("Time");
  curve.unit = "s";
  curve.values = seconds;
  if (const auto fit = assessment::FitLearningCurve(seconds); fit.ok()) {
    curve.fit = report::CurveFit{fit->plateau, fit->gain, fit->rate};
    page.findings.push_back(
        fit->gain == 0
            ? host::TranslateCount("Time: no learning to be seen in {1} completed attempt.",
                                   "Time: no learning to be seen in {1} completed attempts.", seconds.size())
            : host::TranslateWith(
                  fit->is_rate_at_bound
                      ? host::Mark("Time: practice leads towards {1}; too few attempts to tell how fast.")
                      : host::Mark("Time: practice leads towards {1}."),
                  {report::FormatDuration(fit->plateau)}));
  } else {
    page.findings.push_back(
        host::TranslateWith("A learning curve takes {1} completed attempts; so far: {2}.",
                            {std::to_string(assessment::kLeastAttempts), std::to_string(seconds.size())}));
  }
  if (const auto trend = assessment::CalcTrend(seconds, assessment::Better::kLower); trend.ok()) {
    const char* const words[] = {host::Mark("no trend"), host::Mark("getting faster"),
                                 host::Mark("getting slower")};
    page.findings.push_back(host::TranslateWith(
        "Trend of the time: {1}.", {host::Translate(words[static_cast<std::size_t>(trend->verdict)])}));
  }
  page.drawings.push_back(report::DrawLearningCurve(curve));
}

void AddCusum(const std::vector<bool>& failed, const std::string& task, HistoryPage& page) {
  if (failed.empty()) return;
  const auto cusum = assessment::CalcCusum(failed);
  if (!cusum.ok()) return;
  report::CusumChart chart;
  chart.task = task;
  chart.values = cusum->values;
  chart.lower = cusum->h0, chart.upper = cusum->h1;
  chart.verdict = host::Translate(assessment::VerdictSentence(cusum->verdict));
  page.findings.push_back(host::TranslateWith("CUSUM: {1}", {chart.verdict}));
  page.drawings.push_back(report::DrawCusum(chart));
}

/// How the newest completed attempt compares with each of the person's groups.
void AddPlaces(Desk& desk, const HistoryQuery& query, const store::Attempt& newest, HistoryPage& page) {
  if (query.person.empty() || !newest.score) return;
  const auto person = store::FindViewer(desk.store, query.person);
  if (!person.ok()) return;
  const auto groups = store::ListGroups(desk.store, *person);
  if (!groups.ok()) return;
  store::MetricKey key;
  key.task = newest.task, key.level = newest.level, key.metric = "score";
  for (const store::Group& group : *groups) {
    const auto place = store::CalcPercentile(desk.store, desk.viewer, group.name, key, *newest.score);
    if (!place.ok()) {
      if (place.error().code == base::ErrorCode::kStoreRefused)
        page.findings.push_back(host::TranslateWith("Group \"{1}\": a place is shown from {2} trainees on.",
                                                    {group.name, std::to_string(store::kFewestTrainees)}));
      continue;
    }
    page.findings.push_back(host::TranslateWith(
        "Group \"{1}\": percentile {2} of {3}, by score.",
        {group.name, report::FormatShown(place->Percent()),
         host::TranslateCount("{1} trainee", "{1} trainees", static_cast<std::size_t>(place->trainees))}));
  }
}

void AddTasks(HistoryPage& page) {
  if (const auto tasks = files::ListTasks(); tasks.ok()) {
    for (const files::TaskEntry& task : *tasks) page.tasks.push_back({task.key, host::Translate(task.name)});
  }
  page.tasks.push_back({procedures::kUsualProcedure, TaskNameOf(procedures::kUsualProcedure)});
}

}  // namespace

base::Result<HistoryPage> LoadHistory(const Access& access, const HistoryQuery& query) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  HistoryPage page;
  page.query = query;
  page.who = query.person.empty() ? host::Translate("Everyone") : NameOf(access, query.person);
  AddTasks(page);
  store::AttemptFilter filter;
  filter.trainee = query.person;
  filter.task = query.task;
  const auto listed = store::ListAttempts(desk->store, desk->viewer, filter, query.page, kRows);
  if (!listed.ok()) return listed.error();
  TaskBook tasks;
  for (const store::StoredAttempt& one : listed->attempts) page.rows.push_back(MakeRow(access, tasks, one));
  page.next = listed->next;
  if (query.task.empty()) return page;

  std::size_t left_out = 0;
  const auto attempts = ListOfTask(*desk, query, page.level, left_out);
  if (!attempts.ok()) return attempts.error();
  if (left_out > 0)
    page.findings.push_back(host::TranslateCount("Not counted here: {1} attempt that is not verified.",
                                                 "Not counted here: {1} attempts that are not verified.",
                                                 left_out));
  std::vector<double> seconds;
  std::vector<bool> failed;
  for (const store::Attempt& attempt : *attempts) {
    if (attempt.is_completed) seconds.push_back(attempt.seconds);
    failed.push_back(!attempt.is_completed || (attempt.is_passed && !*attempt.is_passed));
  }
  // several people's attempts in one row would be nobody's learning
  const bool is_of_one = std::all_of(attempts->begin(), attempts->end(), [&](const store::Attempt& attempt) {
    return attempt.trainee == attempts->front().trainee;
  });
  if (is_of_one) {
    const std::string task = TaskNameOf(query.task) + (page.level.empty() ? "" : ", " + page.level);
    AddCurve(seconds, task, page);
    AddCusum(failed, task, page);
  }
  const auto completed = std::find_if(attempts->rbegin(), attempts->rend(),
                                      [](const store::Attempt& attempt) { return attempt.is_completed; });
  if (completed != attempts->rend()) AddPlaces(*desk, query, *completed, page);
  return page;
}

}  // namespace trocar::centre
