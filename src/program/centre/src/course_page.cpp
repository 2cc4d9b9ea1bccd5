// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/course_page.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <map>
#include <random>
#include <utility>

#include "trocar/host/translate.h"
#include "trocar/scene/scene.h"
#include "trocar/store/attempts.h"
#include "trocar/store/courses.h"
#include "words.h"

namespace trocar::centre {
namespace {

using assessment::Attempt;
using assessment::Course;
using assessment::Step;
using assessment::StepState;

constexpr int kPage = 1000;  // attempts that are asked for at once
/// Seeds that a person can type.
constexpr std::uint64_t kMostSeed = 2147483647;

std::chrono::sys_days Today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  return std::chrono::sys_days(std::chrono::year_month_day(
      std::chrono::year(local.tm_year + 1900), std::chrono::month(static_cast<unsigned>(local.tm_mon) + 1),
      std::chrono::day(static_cast<unsigned>(local.tm_mday))));
}

std::string WhatOf(const Step& step) {
  if (!step.IsOperation()) return TaskNameOf(step.task) + ", " + host::Translate(step.level);
  std::string text = TaskNameOf(step.operation);
  if (!step.patient.Text().empty()) text += host::TranslateWith(", patient of {1}", {step.patient.Text()});
  return text + ", " + host::Translate(assessment::DescribeUntil(step.until));
}

/// An attempt of the store as courses judge it.
Attempt Convert(const store::Attempt& from, const Course& course) {
  Attempt attempt;
  const StepName name = FindStepName(from);
  attempt.task = from.task, attempt.level = from.level, attempt.seed = from.seed;
  attempt.patient = from.patient;
  attempt.started = from.started, attempt.recording = from.recording;
  attempt.score = from.score;
  attempt.result = {from.is_completed, {from.metrics}};
  if (!name.IsSet()) return attempt;
  attempt.course = name.course, attempt.step = name.step;
  const Step* step = name.course == course.key ? course.Find(name.step) : nullptr;
  if (step != nullptr) attempt.from = step->from, attempt.until = step->until;
  return attempt;
}

/// The person's attempts at tasks of the course, the oldest first.
base::Result<std::vector<Attempt>> ListAttemptsAt(Desk& desk, const std::string& person, const Course& course,
                                                  std::size_t& left_out) {
  std::vector<std::string> tasks;
  for (const Step& step : course.steps) {
    const std::string& task = step.IsOperation() ? step.operation : step.task;
    if (std::find(tasks.begin(), tasks.end(), task) == tasks.end()) tasks.push_back(task);
  }
  std::vector<Attempt> attempts;
  for (const std::string& task : tasks) {
    store::AttemptFilter filter;
    filter.trainee = person;
    filter.task = task;
    std::string from;
    do {
      const auto page = store::ListAttempts(desk.store, desk.viewer, filter, from, kPage);
      if (!page.ok()) return page.error();
      for (const store::StoredAttempt& one : page->attempts) {
        if (one.attempt.trainee != person) continue;
        if (!one.attempt.mark.Counts()) {
          ++left_out;
          continue;
        }
        const auto whole = store::FindAttempt(desk.store, desk.viewer, one.id);
        if (!whole.ok()) return whole.error();
        attempts.push_back(Convert(whole->attempt, course));
      }
      from = page->next;
    } while (!from.empty());
  }
  // by the clock, whatever its offset
  std::vector<std::pair<std::int64_t, std::size_t>> order;
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const auto time = store::ParseTime(attempts[i].started);
    order.emplace_back(time.ok() ? *time : 0, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<Attempt> sorted;
  for (const auto& [time, i] : order) sorted.push_back(std::move(attempts[i]));
  return sorted;
}

std::string ProgressText(const Step& step, const assessment::StepProgress& now) {
  if (now.attempts == 0) return host::Translate("not tried yet");
  std::string text =
      host::TranslateWith("{1} of {2} passes", {std::to_string(now.passes), std::to_string(step.passes)});
  if (step.consecutive_passes > 1)
    text += host::TranslateWith(", {1} of {2} in a row",
                                {std::to_string(now.longest_run), std::to_string(step.consecutive_passes)});
  return text + ", " + host::TranslateCount("{1} attempt", "{1} attempts", now.attempts);
}

CoursePage::Step MakeStep(const Course& course, const Step& step, const assessment::StepProgress& now) {
  CoursePage::Step shown;
  shown.key = step.key, shown.name = host::Translate(step.name);
  shown.goal = host::Translate(step.goal), shown.briefing = host::Translate(step.briefing);
  shown.what = WhatOf(step);
  shown.task = step.task;
  shown.state = now.state;
  shown.progress = ProgressText(step, now);
  for (const std::string& key : now.locked_by) {
    const Step* other = course.Find(key);
    shown.locked_by +=
        (shown.locked_by.empty() ? "" : ", ") + (other != nullptr ? host::Translate(other->name) : key);
  }
  if (now.due) {
    shown.due = host::TranslateWith(now.is_overdue ? host::Mark("overdue since {1}") : host::Mark("due {1}"),
                                    {assessment::FormatDay(*now.due)});
    shown.is_overdue = now.is_overdue;
  }
  for (const assessment::Threshold& threshold : step.proficiency.thresholds)
    shown.thresholds.push_back(ThresholdText(threshold));
  return shown;
}

std::uint64_t DrawSeed() {
  std::random_device random;
  return std::uniform_int_distribution<std::uint64_t>(1, kMostSeed)(random);
}

}  // namespace

base::Result<LoadedCourse> LoadCourse(const Access& access, const std::string& course_key) {
  const auto all = assessment::ListCourses();
  if (!all.ok()) return all.error();
  LoadedCourse loaded;
  CoursePage& page = loaded.page;
  for (const Course& one : *all) page.courses.push_back({one.key, host::Translate(one.name)});
  if (all->empty()) return loaded;
  page.who = NameOf(access, access.person);

  auto desk = OpenDesk(access);
  if (!desk.ok()) loaded.store_failure = desk.error();
  std::vector<store::Assignment> assignments;
  if (desk.ok() && !access.person.empty()) {
    auto listed = store::ListAssignments(desk->store, desk->viewer, access.person);
    if (listed.ok()) assignments = std::move(*listed);
  }
  std::string key = course_key;
  if (key.empty()) key = assignments.empty() ? all->front().key : assignments.front().course;
  const auto course = assessment::FindCourse(key);
  if (!course.ok()) return course.error();
  page.course = course->key;
  page.name = host::Translate(course->name), page.about = host::Translate(course->about);

  std::vector<Attempt> attempts;
  assessment::CourseDates dates;
  dates.today = Today();
  if (desk.ok()) {
    auto listed = ListAttemptsAt(*desk, access.person, *course, page.unverified);
    if (listed.ok()) {
      attempts = std::move(*listed);
    } else {
      loaded.store_failure = listed.error();
    }
  }
  if (page.unverified > 0)
    page.note = host::TranslateCount(
        "{1} attempt is not verified and does not count here; trocar store verify --attempts replays it.",
        "{1} attempts are not verified and do not count here; trocar store verify --attempts replays them.",
        page.unverified);
  // a course begins with the first attempt at it
  if (!attempts.empty()) dates.started = assessment::ParseDay(attempts.front().started.substr(0, 10));
  const auto progress = assessment::CalcProgress(*course, attempts, dates);
  for (std::size_t i = 0; i < course->steps.size(); ++i)
    page.steps.push_back(MakeStep(*course, course->steps[i], progress.steps[i]));
  if (progress.next) page.next = course->steps[*progress.next].key;
  return loaded;
}

base::Result<Start> PrepareStart(
    const StepName& name, const std::function<bool(const assessment::PreparationProgress&)>& progress) {
  const auto course = assessment::FindCourse(name.course);
  if (!course.ok()) return course.error();
  const auto step = assessment::FindStep(*course, name.step);
  if (!step.ok()) return step.error();
  assessment::PreparationSettings settings;
  settings.progress = progress;
  const auto prepared = assessment::PrepareStep(*step, settings);
  if (!prepared.ok()) return prepared.error();
  Start start;
  record::Description& description = start.description;
  description.kind =
      step->IsOperation() ? record::Description::Kind::kOperation : record::Description::Kind::kTask;
  description.name = step->IsOperation() ? step->operation : step->task;
  description.level = step->level;
  description.patient = prepared->patient.string();
  // the expert who came so far operated on the scene of this seed
  description.seed = step->IsOperation() ? settings.surgeon_seed : step->seed.value_or(DrawSeed());
  start.state = prepared->state;
  start.state_surgeon = prepared->surgeon;
  start.title = step->name;
  start.from = step->from, start.until = step->until;
  start.step = name;
  return start;
}

std::string DescribePreparation(const assessment::PreparationProgress& now) {
  constexpr double kMinute = 60;  // [s]
  const std::string percent = std::to_string(static_cast<int>(100 * now.share));
  if (now.is_late) return host::TranslateWith("{1} %, and it takes longer than usual", {percent});
  if (!now.seconds_left) return host::TranslateWith("{1} %", {percent});
  if (*now.seconds_left < kMinute) return host::TranslateWith("{1} %, less than a minute left", {percent});
  return host::TranslateWith(
      "{1} %, about {2} min left",
      {percent, std::to_string(static_cast<int>(std::ceil(*now.seconds_left / kMinute)))});
}

}  // namespace trocar::centre
