// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/best_results.h"

#include <algorithm>
#include <utility>

#include "trocar/centre/course_page.h"
#include "trocar/centre/history_page.h"
#include "trocar/host/translate.h"
#include "trocar/report/attempt_report.h"
#include "trocar/store/attempts.h"
#include "words.h"

namespace trocar::centre {
namespace {

constexpr int kPage = 1000, kMostPages = 5;

}  // namespace

base::Result<BestResults> LoadBestResults(const Access& access) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  store::AttemptFilter filter;
  filter.trainee = access.person;
  BestResults results;
  TaskBook tasks;
  std::string from;
  for (int count = 0; count < kMostPages; ++count) {
    const auto page = store::ListAttempts(desk->store, desk->viewer, filter, from, kPage);
    if (!page.ok()) return page.error();
    for (const store::StoredAttempt& stored : page->attempts) {
      const store::Attempt& attempt = stored.attempt;
      if (attempt.trainee != access.person) continue;  // without a person the owner sees everyone's
      BestResult& best = results[{attempt.task, attempt.level}];
      if (!attempt.mark.Counts()) ++best.unverified;
      if (best.attempts++ == 0) best.is_score_percent = tasks.IsScorePercent(attempt.task, attempt.level);
      if (!attempt.CountsAsCompleted()) continue;
      ++best.completed;
      if (attempt.score) best.score = std::max(best.score.value_or(*attempt.score), *attempt.score);
      best.seconds = std::min(best.seconds.value_or(attempt.seconds), attempt.seconds);
    }
    from = page->next;
    if (from.empty()) break;
  }
  return results;
}

base::Result<HomeResults> LoadHomeResults(const Access& access) {
  auto best = LoadBestResults(access);
  if (!best.ok()) return best.error();
  HomeResults results{std::move(*best), {}};
  if (access.person.empty()) return results;  // everybody's last is nobody's
  const auto course = LoadCourse(access, {});
  if (!course.ok()) return course.error();
  for (const CoursePage::Step& step : course->page.steps) {
    if (step.key != course->page.next) continue;
    results.leads.next =
        NextAndLast::Step{{course->page.course, step.key}, course->page.name, step.name, step.task, step.due};
  }
  const auto history = LoadHistory(access, {access.person, {}, {}});
  if (!history.ok()) return history.error();
  if (!history->rows.empty()) {
    const HistoryPage::Row& row = history->rows.front();
    results.leads.last = NextAndLast::Result{
        row.task, row.outcome + (row.score.empty() ? "" : ", " + row.score) + ", " + row.time,
        row.attempt.task, row.attempt, row.recording};
  }
  return results;
}

std::string DescribeBest(const BestResults& results, const std::string& task, const std::string& level) {
  const auto found = results.find({task, level});
  if (found == results.end()) return host::Translate("Not tried yet");
  const BestResult& best = found->second;
  const std::string unverified =
      best.unverified == 0
          ? std::string()
          : "; " + host::TranslateCount("{1} not verified", "{1} not verified", best.unverified);
  if (best.completed == 0)
    return host::TranslateCount("Not completed in {1} attempt", "Not completed in {1} attempts",
                                best.attempts) +
           unverified;
  std::string what = best.score ? ScoreText(*best.score, best.is_score_percent) + ", " : "";
  what += report::FormatClock(best.seconds.value_or(0));
  return host::TranslateWith("Best {1}; {2}",
                             {what, host::TranslateCount("{1} attempt", "{1} attempts", best.attempts)}) +
         unverified;
}

}  // namespace trocar::centre
