// SPDX-License-Identifier: Apache-2.0
// The store of a large centre: how long a page of a trainee's history takes, and how a trainee compares with a group.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/bench/benchmark.h"
#include "trocar/store/attempts.h"
#include "trocar/store/maintenance.h"
#include "work_folder.h"

namespace trocar::bench {
namespace {

using store::Store;
using store::Viewer;

constexpr int kPerTrainee = 100;  // attempts
constexpr int kGroupMembers = 20;
constexpr int kTasks = 10, kLevels = 3;
constexpr int kQuestions = 2000;         // of each kind
constexpr int kLargeQuestions = 200;     // of those that look at everybody
constexpr std::size_t kBatch = 100'000;  // attempts in a transaction; after each, standings are counted anew

const Viewer kOwner = Viewer::Owner();

std::string TaskName(int number) {
  return "task_" + std::to_string(number);
}

store::Attempt MakeAttempt(int number, const std::vector<std::string>& trainees, std::mt19937_64& random) {
  store::Attempt attempt;
  attempt.recording_id = base::HashText(static_cast<std::uint64_t>(number) * 0x9e3779b97f4a7c15ULL);
  char started[40];
  const auto day = static_cast<int>(random() % 336);
  std::snprintf(started, sizeof started, "2026-%02d-%02dT%02d:%02d:%02d+01:00", 1 + day / 28, 1 + day % 28,
                static_cast<int>(random() % 24), static_cast<int>(random() % 60),
                static_cast<int>(random() % 60));
  attempt.started = started;
  attempt.trainee = trainees[random() % trainees.size()];
  attempt.task = TaskName(static_cast<int>(random() % kTasks));
  attempt.level = std::to_string(random() % kLevels);
  attempt.seed = random() % 1000;
  attempt.seconds = 30.0 + static_cast<double>(random() % 3000) / 10;
  attempt.is_completed = random() % 10 != 0;
  attempt.score = static_cast<double>(random() % 1000) / 10;
  attempt.outcome = R"({"seconds":60,"task":{"phase":"completed","score":50}})";
  attempt.recording = "/home/trocar/recordings/" + attempt.recording_id + ".trocar";
  attempt.program = "0.1.0";
  attempt.mark.state = store::Verification::kRecordedHere;
  attempt.mark.why = store::WhyUnverified::kNone;
  attempt.metrics = {{"path_length", "left", "", static_cast<double>(random() % 4000) / 1000, ""},
                     {"path_length", "right", "", static_cast<double>(random() % 4000) / 1000, ""}};
  return attempt;
}

base::Result<std::vector<std::string>> Fill(Store& target, int attempts) {
  std::vector<std::string> trainees;
  const int people = std::max(kGroupMembers, attempts / kPerTrainee);
  if (auto all = AddGroup(target, kOwner, "all"); !all.ok()) return all.error();
  for (int p = 0; p < people; ++p) {
    const auto person = AddPerson(target, kOwner, store::Role::kTrainee);
    if (!person.ok()) return person.error();
    trainees.push_back(person->pseudonym);
    const std::string group = "group " + std::to_string(p / kGroupMembers);
    if (p % kGroupMembers == 0) {
      if (auto added = AddGroup(target, kOwner, group); !added.ok()) return added.error();
    }
    for (const std::string& joined : {std::string("all"), group}) {
      if (auto done = JoinGroup(target, kOwner, joined, trainees.back()); !done.ok()) return done.error();
    }
  }
  std::mt19937_64 random(1);
  std::vector<store::Attempt> batch;
  for (int i = 0; i < attempts; ++i) {
    batch.push_back(MakeAttempt(i, trainees, random));
    if (batch.size() < kBatch && i + 1 < attempts) continue;
    const auto added = AddAttempts(target, kOwner, batch);
    if (!added.ok()) return added.error();
    if (*added != static_cast<std::int64_t>(batch.size())) return WrongAnswer("fill", "attempts were lost");
    batch.clear();
  }
  if (auto counted = UpdateStatistics(target); !counted.ok()) return counted.error();
  return trainees;
}

/// Times of one kind of question.
class Times {
 public:
  template <typename Question>
  auto Ask(const Question& question) {
    const host::Stopwatch watch;
    auto answer = question();
    milliseconds_.push_back(1e3 * watch.Seconds());
    return answer;
  }
  void Report(const std::string& name, BenchmarkResult& result) const {
    result.cases.push_back({name + "/p50", base::CalcPercentile(milliseconds_, 0.5), "ms"});
    result.cases.push_back({name + "/p99", base::CalcPercentile(milliseconds_, 0.99), "ms"});
  }

 private:
  std::vector<double> milliseconds_;
};

/// Pages of one kind, each checked: newest first, and only of those who were asked for.
base::Status TimePages(Store& target, const std::string& name, int questions,
                       const std::function<store::AttemptFilter(std::mt19937_64&)>& make_filter,
                       BenchmarkResult& result) {
  Times times;
  std::mt19937_64 random(2);
  for (int q = 0; q < questions; ++q) {
    const store::AttemptFilter filter = make_filter(random);
    std::string page;
    for (int p = 0; p < 2; ++p) {  // the first page, and the one behind it
      const auto found = times.Ask([&] { return ListAttempts(target, kOwner, filter, page, 20); });
      if (!found.ok()) return found.error();
      std::int64_t last = std::numeric_limits<std::int64_t>::max();
      for (const store::StoredAttempt& stored : found->attempts) {
        const auto started = store::ParseTime(stored.attempt.started);
        if (!started.ok() || *started > last) return WrongAnswer(name, "the order is wrong");
        last = *started;
        if ((!filter.trainee.empty() && stored.attempt.trainee != filter.trainee) ||
            (!filter.task.empty() && stored.attempt.task != filter.task))
          return WrongAnswer(name, "another's attempt is on the page");
      }
      page = found->next;
      if (page.empty()) break;
    }
  }
  times.Report(name, result);
  return {};
}

base::Status TimePercentiles(Store& target, const std::string& name, int questions,
                             const std::function<std::string(std::mt19937_64&)>& make_group,
                             BenchmarkResult& result) {
  Times times;
  std::mt19937_64 random(3);
  for (int q = 0; q < questions; ++q) {
    const std::string group = make_group(random);
    const store::MetricKey key{TaskName(static_cast<int>(random() % kTasks)),
                               std::to_string(random() % kLevels),
                               "path_length",
                               random() % 2 == 0 ? "left" : "right",
                               "",
                               ""};
    const double value = static_cast<double>(random() % 4000) / 1000;
    const auto found = times.Ask([&] { return CalcPercentile(target, kOwner, group, key, value); });
    if (!found.ok()) return found.error();
    if (q % 20 != 0) continue;
    const auto values = ListGroupValues(target, kOwner, group, key);
    if (!values.ok()) return values.error();
    const auto below =
        std::count_if(values->begin(), values->end(), [&](double other) { return other < value; });
    if (found->below != below || found->trainees != static_cast<std::int64_t>(values->size()))
      return WrongAnswer(name, "the percentile is another one when it is counted by hand");
  }
  times.Report(name, result);
  return {};
}

}  // namespace

base::Result<BenchmarkResult> RunStoreBenchmark(const BenchmarkOptions& options) {
  const WorkFolder folder;
  if (auto made = folder.Status(); !made) return made.error();
  store::Place place;
  place.folder = folder.Path() / "files";
  place.url = options.url.empty() ? (folder.Path() / "store.sqlite").string() : options.url;
  auto target = Store::Open(place);
  if (!target.ok()) return target.error();
  const auto counts = CountAll(*target, kOwner);
  if (!counts.ok()) return counts.error();
  if (counts->people + counts->attempts > 0)
    return base::Error{base::ErrorCode::kUsage, "the benchmark fills an empty store; name an empty database"};
  const host::Stopwatch filling;
  const auto trainees = Fill(*target, options.attempts);
  if (!trainees.ok()) return trainees.error();
  BenchmarkResult result;
  result.notes.push_back(std::string(place.IsPostgres() ? "PostgreSQL" : "SQLite") + ", " +
                         std::to_string(options.attempts) + " attempts of " +
                         std::to_string(trainees->size()) +
                         " trainees; pages of 20, each the first and the second");
  result.cases.push_back({"fill/rate", options.attempts / filling.Seconds(), "attempts/s"});
  const auto any = [&](std::mt19937_64& random) { return (*trainees)[random() % trainees->size()]; };
  const auto some_group = [&](std::mt19937_64& random) {
    return "group " + std::to_string(random() % ((trainees->size() + kGroupMembers - 1) / kGroupMembers));
  };
  for (const auto& done :
       {TimePages(
            *target, "history/trainee", kQuestions,
            [&](auto& random) {
              return store::AttemptFilter{any(random), "", ""};
            },
            result),
        TimePages(
            *target, "history/trainee_task", kQuestions,
            [&](auto& random) {
              return store::AttemptFilter{any(random), "", TaskName(static_cast<int>(random() % kTasks))};
            },
            result),
        TimePages(
            *target, "history/everybody", kQuestions, [&](auto&) { return store::AttemptFilter{}; }, result),
        TimePages(
            *target, "history/group_of_20", kQuestions,
            [&](auto& random) {
              return store::AttemptFilter{"", some_group(random), ""};
            },
            result),
        TimePages(
            *target, "history/group_of_all", kLargeQuestions,
            [&](auto&) {
              return store::AttemptFilter{"", "all", ""};
            },
            result),
        TimePercentiles(*target, "percentile/group_of_20", kQuestions, some_group, result),
        TimePercentiles(
            *target, "percentile/group_of_all", kLargeQuestions, [](auto&) { return "all"; }, result)}) {
    if (!done.ok()) return done.error();
  }
  Times adding;
  std::mt19937_64 random(4);
  for (int i = 0; i < kLargeQuestions; ++i) {
    const store::Attempt attempt = MakeAttempt(options.attempts + i, *trainees, random);
    const auto added = adding.Ask([&] { return AddAttempt(*target, attempt); });
    if (!added.ok()) return added.error();
    if (!*added) return WrongAnswer("add", "the attempt was not new");
  }
  adding.Report("add/attempt", result);
  return result;
}

}  // namespace trocar::bench
