// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/group_page.h"

#include <algorithm>
#include <map>
#include <utility>

#include "trocar/centre/judged_attempt.h"
#include "trocar/host/translate.h"
#include "trocar/store/attempts.h"
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

}  // namespace

base::Result<GroupPage> LoadGroup(const Access& access, const std::string& group) {
  auto desk = OpenDesk(access);
  if (!desk.ok()) return desk.error();
  if (desk->viewer.role == store::Role::kTrainee) {
    return base::Error{base::ErrorCode::kStoreRefused,
                       "groups are for instructors; say at \"Who are you?\" who you are"};
  }
  GroupPage page;
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
