// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/course.h"

#include <algorithm>
#include <cstdio>

namespace trocar::assessment {
namespace {

/// Follows one step through the attempts.
class StepCount {
 public:
  explicit StepCount(const Step& step) : step_(&step) {}

  void Add(bool is_passed) {
    ++attempts_;
    if (!is_passed) {
      run_ = 0;
      return;
    }
    ++passes_;
    longest_run_ = std::max(longest_run_, ++run_);
  }
  bool IsDone() const { return longest_run_ >= step_->consecutive_passes && passes_ >= step_->passes; }
  std::size_t Attempts() const { return attempts_; }
  std::size_t Passes() const { return passes_; }
  std::size_t LongestRun() const { return longest_run_; }

 private:
  const Step* step_;
  std::size_t attempts_ = 0, passes_ = 0, run_ = 0, longest_run_ = 0;
};

}  // namespace

std::string PatientChoice::Text() const {
  if (!folder.empty()) return folder.string();
  if (!seed) return "";
  std::string text = "seed " + std::to_string(*seed);
  for (const auto& [name, value] : settings) text += ", " + name + "=" + value;
  return text;
}

const Step* Course::Find(std::string_view key_of_step) const {
  for (const Step& step : steps) {
    if (step.key == key_of_step) return &step;
  }
  return nullptr;
}

std::string_view NameOf(StepState state) noexcept {
  constexpr std::string_view kNames[] = {"locked", "open", "done"};
  return kNames[static_cast<std::size_t>(state)];
}

bool IsAttemptAt(const Course& course, const Step& step, const Attempt& attempt) {
  if (!attempt.step.empty()) return attempt.course == course.key && attempt.step == step.key;
  if (!step.IsOperation())
    return attempt.task == step.task && attempt.level == step.level &&
           (!step.seed || *step.seed == attempt.seed);
  return attempt.task == step.operation && attempt.patient == step.patient.Text() &&
         attempt.from == step.from && attempt.until == step.until;
}

CourseProgress CalcProgress(const Course& course, std::span<const Attempt> attempts,
                            const CourseDates& dates) {
  std::vector<StepCount> counts;
  for (const Step& step : course.steps) counts.emplace_back(step);
  const auto blockers = [&](const Step& step) {
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < course.steps.size(); ++i) {
      const auto& wanted = step.prerequisites;
      if (std::find(wanted.begin(), wanted.end(), course.steps[i].key) != wanted.end() && !counts[i].IsDone())
        missing.push_back(course.steps[i].key);
    }
    return missing;
  };
  for (const Attempt& attempt : attempts) {
    // which steps are open is asked before any of them is moved on by this attempt
    std::vector<std::size_t> at;
    for (std::size_t i = 0; i < course.steps.size(); ++i) {
      if (IsAttemptAt(course, course.steps[i], attempt) && blockers(course.steps[i]).empty()) at.push_back(i);
    }
    for (const std::size_t i : at)
      counts[i].Add(Judge(course.steps[i].proficiency, attempt.result).is_passed);
  }
  CourseProgress progress;
  for (std::size_t i = 0; i < course.steps.size(); ++i) {
    const Step& step = course.steps[i];
    StepProgress now;
    now.key = step.key;
    now.attempts = counts[i].Attempts();
    now.passes = counts[i].Passes();
    now.longest_run = counts[i].LongestRun();
    now.locked_by = blockers(step);
    now.state = counts[i].IsDone()      ? StepState::kDone
                : now.locked_by.empty() ? StepState::kOpen
                                        : StepState::kLocked;
    if (step.due_days && dates.started) {
      now.due = *dates.started + std::chrono::days(*step.due_days);
      now.is_overdue = now.state != StepState::kDone && dates.today && *dates.today > *now.due;
    }
    if (now.state == StepState::kOpen) {
      const bool is_sooner =
          progress.next && now.due &&
          (!progress.steps[*progress.next].due || *now.due < *progress.steps[*progress.next].due);
      if (!progress.next || is_sooner) progress.next = i;
    }
    progress.steps.push_back(std::move(now));
  }
  return progress;
}

std::optional<std::chrono::sys_days> ParseDay(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  int parts[3] = {};
  constexpr std::pair<std::size_t, std::size_t> kPlaces[] = {{0, 4}, {5, 2}, {8, 2}};
  for (std::size_t part = 0; part < 3; ++part) {
    for (const char digit : text.substr(kPlaces[part].first, kPlaces[part].second)) {
      if (digit < '0' || digit > '9') return std::nullopt;
      parts[part] = 10 * parts[part] + (digit - '0');
    }
  }
  const std::chrono::year_month_day day{std::chrono::year(parts[0]),
                                        std::chrono::month(static_cast<unsigned>(parts[1])),
                                        std::chrono::day(static_cast<unsigned>(parts[2]))};
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day);
}

std::string FormatDay(std::chrono::sys_days day) {
  const std::chrono::year_month_day date{day};
  char text[32];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  return text;
}

}  // namespace trocar::assessment
