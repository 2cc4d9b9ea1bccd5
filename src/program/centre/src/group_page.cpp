// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/group_page.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "trocar/assessment/course.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/store/attempts.h"
#include "trocar/store/courses.h"
#include "words.h"

namespace trocar::centre {
namespace {

constexpr int kPage = 1000;  // rows that are asked for at once

/// What a member came to in a task.
struct Tally {
  std::size_t attempts = 0, completed = 0, unverified = 0;
  bool is_passed = false, is_judged = false;
  std::optional<double> last, best;  // score
  std::string level;                 // of the newest: only it counts for scores
};

base::Result<std::vector<std::string>> ListMembers(Desk& desk, const std::string& group) {
  std::vector<std::string> members;
  for (std::string after;;) {
    const auto people = store::ListPeople(desk.store, desk.viewer, after, kPage);
    if (!people.ok()) return people.error();
    if (people->empty()) return members;
    for (const store::Person& person : *people) {
      const bool is_member =
          std::find(person.groups.begin(), person.groups.end(), group) != person.groups.end();
      if (is_member && person.role == store::Role::kTrainee) members.push_back(person.pseudonym);
    }
    after = people->back().pseudonym;
  }
}

void Add(const store::Attempt& attempt, Tally& tally) {
  ++tally.attempts;
  // what a file says of itself does not decide
  if (!attempt.mark.Counts()) {
    ++tally.unverified;
    return;
  }
  if (tally.attempts - tally.unverified == 1) tally.level = attempt.level;
  tally.completed += attempt.is_completed ? 1 : 0;
  tally.is_judged = tally.is_judged || attempt.is_passed.has_value();
  tally.is_passed = tally.is_passed || (attempt.is_completed && attempt.is_passed && *attempt.is_passed);
  if (!attempt.score || !attempt.is_completed || attempt.level != tally.level) return;
  if (!tally.last) tally.last = attempt.score;  // the newest comes first
  tally.best = std::max(tally.best.value_or(*attempt.score), *attempt.score);
}

GroupPage::Cell MakeCell(const Tally& tally, TaskBook& tasks, const std::string& task) {
  GroupPage::Cell cell;
  cell.attempts = tally.attempts;
  if (tally.attempts == 0) return cell;
  cell.text = host::TranslateCount("{1} attempt", "{1} attempts", tally.attempts);
  if (tally.last) {
    const bool is_percent = tasks.IsScorePercent(task, tally.level);
    cell.text += "\n" + host::TranslateWith("last {1}, best {2}", {ScoreText(*tally.last, is_percent),
                                                                   ScoreText(*tally.best, is_percent)});
  } else {
    cell.text += "\n" + host::TranslateWith("{1} completed", {std::to_string(tally.completed)});
  }
  if (tally.unverified > 0)
    cell.text += "\n" + host::TranslateCount("{1} not verified", "{1} not verified", tally.unverified);
  cell.is_passed = tally.is_passed;
  cell.text += tally.is_passed   ? "\n" + host::Translate("passed")
               : tally.is_judged ? "\n" + host::Translate("not passed yet")
                                 : "";
  cell.tone = tally.is_passed ? Tone::kGood : tally.is_judged ? Tone::kCaution : Tone::kPlain;
  return cell;
}

/// The course as it lies in the file, so that the store knows what it was when it was assigned.
base::Result<store::Course> ReadForStore(const assessment::Course& course) {
  const auto text = host::ReadFile(course.path);
  if (!text.ok()) return text.error();
  store::Course kept{course.key, 1, *text, {}};
  for (const assessment::Step& step : course.steps)
    kept.steps.push_back({step.key, step.IsOperation() ? step.operation : step.task, step.level});
  return kept;
}

/// Stores the course, as a new version where the store's newest has another text.
base::Result<int> KeepCourse(Desk& desk, store::Course course) {
  const auto known = store::FindCourse(desk.store, course.key);
  if (known.ok()) course.version = known->text == course.text ? known->version : known->version + 1;
  if (const auto added = store::AddCourse(desk.store, desk.viewer, course); !added.ok()) return added.error();
  return course.version;
}

}  // namespace

base::Status MakeGroup(const Access& access, const std::string& name) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  const auto added = store::AddGroup(desk->store, desk->viewer, name);
  if (!added.ok()) return added.error();
  // whoever makes a group leads it, and sees its members
  return access.person.empty() ? base::Status()
                               : store::JoinGroup(desk->store, desk->viewer, name, access.person);
}

base::Status JoinGroup(const Access& access, const std::string& group, const std::string& who) {
  const auto pseudonym = FindPseudonym(access, who);
  if (!pseudonym.ok()) return pseudonym.error();
  if (pseudonym->empty())
    return base::Error{base::ErrorCode::kStoreInvalid, "nobody was named; type a name or a pseudonym"};
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  return store::JoinGroup(desk->store, desk->viewer, group, *pseudonym);
}

base::Status LeaveGroup(const Access& access, const std::string& group, const std::string& pseudonym) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  return store::LeaveGroup(desk->store, desk->viewer, group, pseudonym);
}

base::Status AssignCourse(const Access& access, const std::string& group, const std::string& course,
                          const std::string& due) {
  store::Assignment assignment;
  assignment.group = group, assignment.course = course;
  if (!due.empty()) {
    const auto day = assessment::ParseDay(due);
    if (!day)
      return base::Error{base::ErrorCode::kStoreInvalid,
                         "\"" + due + "\" is no day; write it as 2026-12-31, or leave it empty"};
    // until the day is over
    assignment.due_ms = std::chrono::duration_cast<std::chrono::milliseconds>(
                            (*day + std::chrono::days(1)).time_since_epoch())
                            .count() -
                        1;
  }
  const auto found = assessment::FindCourse(course);
  if (!found.ok()) return found.error();
  auto text = ReadForStore(*found);
  if (!text.ok()) return text.error();
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  const auto version = KeepCourse(*desk, std::move(*text));
  if (!version.ok()) return version.error();
  assignment.version = *version;
  return store::AddAssignment(desk->store, desk->viewer, assignment);
}

base::Result<GroupPage> LoadGroup(const Access& access, const std::string& group) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  if (desk->viewer.role == store::Role::kTrainee) {
    return base::Error{base::ErrorCode::kStoreRefused,
                       "groups are for instructors; say at \"Who are you?\" who you are"};
  }
  GroupPage page;
  const auto courses = assessment::ListCourses();
  if (!courses.ok()) return courses.error();
  for (const assessment::Course& course : *courses)
    page.courses.push_back({course.key, host::Translate(course.name)});
  const auto groups = store::ListGroups(desk->store, desk->viewer);
  if (!groups.ok()) return groups.error();
  for (const store::Group& one : *groups) page.groups.push_back(one.name);
  if (page.groups.empty()) return page;
  const bool is_there = std::find(page.groups.begin(), page.groups.end(), group) != page.groups.end();
  page.group = is_there ? group : page.groups.front();
  const auto members = ListMembers(*desk, page.group);
  if (!members.ok()) return members.error();

  std::map<std::string, std::map<std::string, Tally>> tallies;  // of tasks, of members
  store::AttemptFilter filter;
  filter.group = page.group;
  std::size_t counted = 0;
  for (std::string from;;) {
    const auto listed = store::ListAttempts(desk->store, desk->viewer, filter, from, kPage);
    if (!listed.ok()) return listed.error();
    for (const store::StoredAttempt& one : listed->attempts)
      Add(one.attempt, tallies[one.attempt.task][one.attempt.trainee]);
    counted += listed->attempts.size();
    from = listed->next;
    if (from.empty()) break;
    if (counted >= kMostGroupAttempts) {
      page.is_cut = true;
      break;
    }
  }
  for (const auto& [task, unused] : tallies) page.tasks.push_back({task, TaskNameOf(task)});
  TaskBook tasks;
  for (const std::string& pseudonym : *members) {
    GroupPage::Member member{pseudonym, NameOf(access, pseudonym), {}};
    for (const GroupPage::Task& task : page.tasks) {
      const auto& of_task = tallies[task.key];
      const auto found = of_task.find(pseudonym);
      member.cells.push_back(found == of_task.end() ? GroupPage::Cell{}
                                                    : MakeCell(found->second, tasks, task.key));
    }
    page.members.push_back(std::move(member));
  }
  return page;
}

}  // namespace trocar::centre
