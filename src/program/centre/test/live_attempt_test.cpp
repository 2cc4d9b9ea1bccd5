// SPDX-License-Identifier: Apache-2.0
// What is measured while an attempt is played is what its replay comes to, in every number.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "recorded_attempt.h"
#include "trocar/centre/attempt_filing.h"
#include "trocar/files/task_file.h"
#include "trocar/report/report_files.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::centre {
namespace {

using assessment::AttemptFold;
using assessment::Milestone;

/// Plays an attempt and follows it. \return what it came to while it was played
std::optional<AttemptFold> Play(const std::filesystem::path& path, const record::Description& description,
                                test::RecordedAttempt attempt) {
  std::optional<AttemptFold> fold;
  attempt.before_first = [&](const simulation::Simulation& simulation) {
    fold.emplace(simulation, Milestone::kStart, Milestone::kCompleted);
  };
  attempt.see = [&](const simulation::Snapshot& now, const scene::Input& input) {
    fold->Add(now, input.controls);
  };
  test::RecordAttempt(path, description, attempt);
  return fold;
}

void ExpectSame(const JudgedAttempt& live, const JudgedAttempt& replayed) {
  const auto &a = live.attempt.metrics, &b = replayed.attempt.metrics;
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 20u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].metric + a[i].hand + a[i].phase + a[i].tool,
              b[i].metric + b[i].hand + b[i].phase + b[i].tool);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i].value), std::bit_cast<std::uint64_t>(b[i].value))
        << a[i].metric;
  }
  EXPECT_EQ(live.attempt.score, replayed.attempt.score);
  EXPECT_EQ(live.attempt.is_completed, replayed.attempt.is_completed);
  EXPECT_EQ(live.attempt.is_passed, replayed.attempt.is_passed);
  EXPECT_EQ(live.attempt.outcome, replayed.attempt.outcome);
  // all that a person reads: errors, goals, advice, curves
  EXPECT_EQ(report::FormatJson(live.report), report::FormatJson(replayed.report));
}

/// Attempts of all tasks and levels in turn, by novices and experts.
void CompareAttempts(int count, std::uint64_t ticks) {
  const test::TemporaryFolder folder;
  const auto tasks = files::ListTasks();
  ASSERT_TRUE(tasks.ok());
  ASSERT_GE(tasks->size(), 8u);
  for (int i = 0; i < count; ++i) {
    const auto& task = (*tasks)[static_cast<std::size_t>(i) % tasks->size()];
    const auto& level = task.levels[(static_cast<std::size_t>(i) / tasks->size()) % task.levels.size()];
    const auto path = folder.Path() / ("attempt" + std::to_string(i) + ".trocar");
    const auto seed = static_cast<std::uint64_t>(i + 1);
    SCOPED_TRACE(task.key + ", " + level + ", " + std::to_string(i));
    const auto fold = Play(path, test::DescribeTask(task.key.c_str(), level.c_str(), seed),
                           {i % 3 == 0 ? "expert" : "novice", seed, ticks});
    ASSERT_TRUE(fold.has_value());
    const auto live = JudgePlayed(path, *fold, {});
    ASSERT_TRUE(live.ok()) << live.error().Text();
    const auto replayed = JudgeRecording(path, {});
    ASSERT_TRUE(replayed.ok()) << replayed.error().Text();
    ExpectSame(*live, *replayed);
    std::filesystem::remove(path);
  }
}

TEST(LiveAttempt, ComesToTheReplaysNumbers) {
  CompareAttempts(11, 700);
}

TEST(LiveAttemptSlow, ComesToTheReplaysNumbersInTwoHundredAttempts) {
  CompareAttempts(200, test::kUntilOver);
}

// An operation of twenty minutes: a tick may wait for the fold some microseconds, and a person for the result five seconds.
TEST(LiveAttemptSlow, CostsLittleInATickAndAtTheEnd) {
  const auto path = files::FindTask("peg_transfer");
  ASSERT_TRUE(path.ok());
  const auto scene = std::make_shared<const scene::Scene>(*files::ReadTask(*path));
  const auto simulation = simulation::Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  AttemptFold fold(*simulation, Milestone::kStart, Milestone::kCompleted);
  simulation::Snapshot now = simulation->GetSnapshot();
  const auto ticks = static_cast<std::uint64_t>(20 * 60 / scene->tick_seconds);
  using Clock = std::chrono::steady_clock;
  double worst = 0;
  const auto begin = Clock::now();
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    now.tick = tick;
    const double t = static_cast<double>(tick) * scene->tick_seconds;
    for (auto& instrument : now.instruments) {
      // reaching to and fro, as hands do
      instrument.X_world_tool.translation = {0.03 * std::sin(2 * t), 0.02 * std::sin(3.1 * t),
                                             -0.1 + 0.02 * std::sin(t)};
      instrument.force = {0, 0, 2 + std::sin(5 * t)};
    }
    const auto before = Clock::now();
    fold.Add(now, {});
    worst = std::max(worst, std::chrono::duration<double>(Clock::now() - before).count());
  }
  const double each =
      std::chrono::duration<double>(Clock::now() - begin).count() / static_cast<double>(ticks);
  // time of the processor: others may share this computer
  const std::clock_t end = std::clock();
  const auto played = fold.Calc();
  const double last = static_cast<double>(std::clock() - end) / CLOCKS_PER_SEC;
  ASSERT_TRUE(played.ok()) << played.error().Text();
  std::printf("%llu ticks: %.2f us each, %.0f us at worst; %.2f s at the end\n",
              static_cast<unsigned long long>(ticks), 1e6 * each, 1e6 * worst, last);
  EXPECT_LT(each, 50e-6);
  EXPECT_LT(last, 5.0);
}

// A control: a tick that was not seen is found.
TEST(LiveAttempt, IsAnotherWhereATickIsMissing) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "attempt.trocar";
  std::optional<AttemptFold> fold;
  test::RecordedAttempt attempt{"novice", 5, 400};
  attempt.before_first = [&](const simulation::Simulation& simulation) {
    fold.emplace(simulation, Milestone::kStart, Milestone::kCompleted);
  };
  attempt.see = [&](const simulation::Snapshot& now, const scene::Input& input) {
    if (now.tick != 200) fold->Add(now, input.controls);
  };
  test::RecordAttempt(path, test::DescribeTask("instrument_navigation", "easy", 5), attempt);
  const auto live = JudgePlayed(path, *fold, {});
  const auto replayed = JudgeRecording(path, {});
  ASSERT_TRUE(live.ok() && replayed.ok());
  bool is_same = true;
  for (std::size_t i = 0; i < live->attempt.metrics.size(); ++i)
    is_same = is_same && live->attempt.metrics[i].value == replayed->attempt.metrics[i].value;
  EXPECT_FALSE(is_same);
}

// The issue: 16.7 N in a task, and no errors.
TEST(TaskForce, FarAboveTheLimitIsOneErrorWithItsPeak) {
  const auto path = files::FindTask("instrument_navigation");
  ASSERT_TRUE(path.ok());
  const auto scene = std::make_shared<const scene::Scene>(*files::ReadTask(*path));
  const auto simulation = simulation::Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  AttemptFold fold(*simulation, Milestone::kStart, Milestone::kCompleted);
  simulation::Snapshot now = simulation->GetSnapshot();
  // up to a peak, a little less, up again, and let go; then what tissue bears
  for (const double force : {0.0, 5.9, 9.0, 16.7, 5.6, 12.0, 3.0, 5.0, 7.0, 0.0}) {
    ++now.tick;
    now.instruments[instrument::kRight].force = {0, 0, force};
    fold.Add(now, {});
  }
  const auto played = fold.Calc();
  ASSERT_TRUE(played.ok()) << played.error().Text();
  std::vector<double> peaks;
  for (const training::AttemptEvent& event : played->trace.events) {
    if (event.kind != training::kExcessForceOfTask) continue;
    EXPECT_TRUE(event.is_error);
    EXPECT_EQ(event.hand, static_cast<int>(instrument::kRight));
    peaks.push_back(event.force);
  }
  EXPECT_EQ(peaks, (std::vector<double>{16.7, 7.0}));
}

// What was given up goes on where it stopped, and comes to the same.
TEST(JudgeRecording, GoesOnWhereItWasGivenUp) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "attempt.trocar";
  test::RecordAttempt(path, test::DescribeTask("instrument_navigation", "easy", 5), {"novice", 5, 600});
  std::unique_ptr<Replaying> going_on;
  int told = 0;
  double first = -1;
  JudgeSettings settings;
  settings.progress = [&](double share) { return ++told, share < 0.4; };
  const auto given_up = JudgeRecording(path, settings, &going_on);
  ASSERT_FALSE(given_up.ok());
  EXPECT_EQ(given_up.error().code, base::ErrorCode::kCancelled);
  ASSERT_NE(going_on, nullptr);
  settings.progress = [&](double share) {
    if (first < 0) first = share;
    return true;
  };
  const auto judged = JudgeRecording(path, settings, &going_on);
  ASSERT_TRUE(judged.ok()) << judged.error().Text();
  EXPECT_EQ(going_on, nullptr);
  EXPECT_GT(first, 0.4);
  const auto whole = JudgeRecording(path, {});
  ASSERT_TRUE(whole.ok());
  ExpectSame(*judged, *whole);
}

// The queue of what an earlier program left does not hold up what has just been played.
TEST(LiveAttempt, IsFiledAtOnceBeforeOlderOnes) {
  const test::TemporaryFolder folder;
  Access access;
  access.place = {folder.Path() / "store.sqlite", folder.Path() / "files"};
  const auto old = folder.Path() / "2026-01-01_000000_old.trocar";
  const auto fresh = folder.Path() / "2026-01-02_000000_new.trocar";
  {
    AttemptFiling killed(access, 1, [] {});
    killed.Begin(old);
    test::RecordAttempt(old, test::DescribeTask("peg_transfer", "normal", 3), {"novice", 3, 6000});
  }
  AttemptFiling filing(access, 1, [] {});
  for (int i = 0; i < 200 && filing.Status().measuring == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_EQ(filing.Status().measuring, 1u) << "the old one waits";
  filing.Begin(fresh);
  std::shared_ptr<LiveAttempt> live;
  test::RecordedAttempt attempt{"novice", 4, 600};
  attempt.before_first = [&](const simulation::Simulation& simulation) {
    live = filing.Follow(fresh, simulation, Milestone::kStart, Milestone::kCompleted);
  };
  attempt.see = [&](const simulation::Snapshot& now, const scene::Input& input) {
    live->Add(now, input.controls);
  };
  test::RecordAttempt(fresh, test::DescribeTask("instrument_navigation", "easy", 4), attempt);
  live->End(true);
  const auto begin = std::chrono::steady_clock::now();
  filing.End(fresh);
  std::vector<FiledAttempt> filed;
  while (filed.empty() && std::chrono::steady_clock::now() - begin < std::chrono::seconds(20)) {
    filed = filing.TakeFiled();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_FALSE(filed.empty());
  EXPECT_EQ(filed[0].recording, fresh) << "the older one waits";
  ASSERT_TRUE(filed[0].judged.has_value());
  EXPECT_EQ(filed[0].judged->attempt.mark.state, store::Verification::kRecordedHere);
  const FilingStatus now = filing.Status();
  ASSERT_EQ(now.pending.size(), 1u) << "the old one is still being measured";
  EXPECT_EQ(now.pending[0].recording, old);
}

}  // namespace
}  // namespace trocar::centre
