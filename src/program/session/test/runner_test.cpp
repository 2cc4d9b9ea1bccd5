// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>
#include <vector>

#include "small_scene.h"
#include "trocar/files/task_file.h"
#include "trocar/record/replay.h"
#include "trocar/session/input_sources.h"

namespace trocar::session {

using instrument::kRight;
using scene::SmallScene;

namespace {

class RunnerTest : public SmallScene {
 protected:
  simulation::Simulation MakeSimulation() {
    auto scene = Read();
    EXPECT_TRUE(scene.ok());
    return std::move(*simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene))));
  }
  /// Waits, for at most ten seconds, until `claim` holds.
  static bool Eventually(const std::function<bool()>& claim) {
    for (int i = 0; i < 2000; ++i) {
      if (claim()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
};

/// Hands at home, and what it was asked.
struct Watched : simulation::InputSource {
  explicit Watched(const scene::Scene& scene) : home(scene::CalcScriptInput(scene, 0)) {}
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override {
    are_in_step = are_in_step && tick == next && before.tick + 1 == tick;
    ++next;
    scene::Input input = home;
    if (tick >= 50) input.hands[kRight].pan += 0.1;
    return input;
  }
  void Wait(const simulation::Snapshot& now) override {
    are_in_step = are_in_step && now.tick + 1 == next;
    ++waits;
  }
  void Reset() override {
    next = 1;
    ++resets;
  }
  bool IsDemonstration() const override { return false; }
  scene::Input home;
  std::atomic<std::uint64_t> next{1};
  std::atomic<int> waits{0}, resets{0};
  std::atomic<bool> are_in_step{true};
};

TEST_F(RunnerTest, AsksItsSourceOnceForEachTickAndForThatTick) {
  auto simulation = MakeSimulation();
  Watched source(simulation.GetScene());
  AttemptKeeping keeping{folder_ / "attempts", {}, {}, {}};
  keeping.description.name = (folder_ / "scene.json").string();
  std::vector<std::uint64_t> told;
  std::uint64_t last = 0;
  std::filesystem::path path;
  {
    Runner runner(std::move(simulation), source,
                  {.keeping = keeping,
                   .after_tick = [&](const simulation::Snapshot& now) { told.push_back(now.tick); }});
    ASSERT_TRUE(Eventually([&] { return source.waits > 3; }));
    EXPECT_EQ(source.next, 1u) << "paused, it is asked for nothing";
    runner.SetPaused(false);
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 150; }));
    runner.SetPaused(true);
    const int waits = source.waits;
    ASSERT_TRUE(Eventually([&] { return source.waits > waits + 3; }));
    last = runner.Latest().tick;
    path = runner.RecordingStatus().value().path;
    runner.Reset();
    runner.Reset();
    ASSERT_TRUE(Eventually([&] { return source.resets == 2; })) << "each of them";
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick == 0; }));
  }
  EXPECT_TRUE(source.are_in_step);
  ASSERT_EQ(told.size(), last);
  for (std::size_t i = 0; i < told.size(); ++i) ASSERT_EQ(told[i], i + 1);
  const auto recording = record::ReadRecording(path);
  ASSERT_TRUE(recording.ok()) << recording.error().Text();
  ASSERT_EQ(recording->inputs.size(), last);
  for (std::size_t i = 0; i < last; ++i)
    EXPECT_EQ(recording->inputs[i].hands[kRight].pan,
              source.home.hands[kRight].pan + (i + 1 >= 50 ? 0.1 : 0));
}

TEST_F(RunnerTest, ShowsTheStartBeforeItRuns) {
  auto simulation = MakeSimulation();
  ScriptSource source(simulation.GetScene());
  Runner runner(std::move(simulation), source);
  EXPECT_TRUE(runner.IsPaused());
  EXPECT_EQ(runner.Latest().tick, 0u);
  EXPECT_FALSE(runner.Latest().positions.empty());
}

TEST_F(RunnerTest, RunsPausesAndResets) {
  auto simulation = MakeSimulation();
  ScriptSource source(simulation.GetScene());
  Runner runner(std::move(simulation), source);
  runner.SetPaused(false);
  ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 20; }));
  runner.SetPaused(true);
  std::uint64_t last = 0;
  ASSERT_TRUE(Eventually([&] {
    const auto tick = runner.Latest().tick;
    const bool is_still = tick == last;
    last = tick;
    return is_still;
  }));
  runner.Reset();
  EXPECT_TRUE(Eventually([&] { return runner.Latest().tick == 0; }));
}

TEST_F(RunnerTest, EndsAtOnceEvenWhileRunning) {
  for (int i = 0; i < 5; ++i) {
    auto simulation = MakeSimulation();
    ScriptSource source(simulation.GetScene());
    Runner runner(std::move(simulation), source);
    runner.SetPaused(false);
  }
}

TEST_F(RunnerTest, KeepsEachAttemptInAFileThatReplaysToTheBit) {
  const auto kept = folder_ / "attempts";
  AttemptKeeping keeping{kept, {}};
  keeping.description.name = (folder_ / "scene.json").string();
  {
    auto simulation = MakeSimulation();
    keeping.description.seed = simulation.GetScene().seed;
    ScriptSource source(simulation.GetScene());
    Runner runner(std::move(simulation), source, {.keeping = keeping});
    for (int attempt = 0; attempt < 2; ++attempt) {
      runner.SetPaused(false);
      ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 140; }));
      EXPECT_EQ(runner.RecordingStatus().value().failure, std::nullopt);
      runner.SetPaused(true);
      runner.Reset();
      ASSERT_TRUE(Eventually([&] { return runner.Latest().tick == 0; }));
    }
    runner.SetPaused(false);
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 5; }));
  }
  // the third was hardly begun
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kept)) {
    if (entry.path().extension() != ".trocar") continue;
    EXPECT_TRUE(std::filesystem::exists(record::IndexPathOf(entry.path())));
    ++count;
    auto recording = record::ReadRecording(entry.path());
    ASSERT_TRUE(recording.ok()) << recording.error().Text();
    EXPECT_TRUE(recording->ending.has_value());
    EXPECT_EQ(recording->description.player, "the demonstration");
    EXPECT_GT(recording->inputs.size(), 140u);
    auto replay = record::Replay::Open(std::move(*recording), 1);
    ASSERT_TRUE(replay.ok()) << replay.error().Text();
    const auto verified = replay->Verify();
    ASSERT_TRUE(verified.ok()) << verified.error().Text();
    EXPECT_TRUE(verified->IsVerified());
  }
  EXPECT_EQ(count, 2);
}

TEST_F(RunnerTest, EndsAnAttemptAndRecordsNoMoreUntilTheReset) {
  const auto kept = folder_ / "attempts";
  AttemptKeeping keeping{kept, {}};
  keeping.description.name = (folder_ / "scene.json").string();
  std::atomic<int> begun{0}, ended{0}, watched{0};
  std::atomic<std::uint64_t> seen{0};
  std::atomic<bool> was_whole{false}, was_before_the_end{false};
  keeping.watch = [&](const std::filesystem::path&, const simulation::Simulation& simulation) {
    ++watched;
    EXPECT_EQ(simulation.GetSnapshot().tick, 0u) << "it is asked where the attempt begins";
    seen = 0;
    return AttemptWatch{[&](const simulation::Snapshot& now, const auto&) {
                          ++seen;
                          EXPECT_EQ(now.tick, seen.load());
                        },
                        [&](bool is_whole) {
                          was_whole = is_whole;
                          was_before_the_end = ended.load() < watched.load();
                        }};
  };
  keeping.on_begin = [&](const std::filesystem::path& path) {
    begun += path.extension() == ".trocar" ? 1 : 0;
  };
  keeping.on_end = [&](const std::filesystem::path& path) { ended += path.extension() == ".trocar" ? 1 : 0; };
  {
    auto simulation = MakeSimulation();
    ScriptSource source(simulation.GetScene());
    Runner runner(std::move(simulation), source, {.keeping = keeping});
    runner.SetPaused(false);
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 140; }));
    EXPECT_EQ(begun.load(), 1);
    EXPECT_EQ(ended.load(), 0);
    runner.EndAttempt();
    ASSERT_TRUE(Eventually([&] { return ended.load() == 1; }));
    const auto path = runner.RecordingStatus().value().path;
    const auto recording = record::ReadRecording(path);
    ASSERT_TRUE(recording.ok()) << recording.error().Text();
    EXPECT_TRUE(recording->ending.has_value()) << "it is whole while the simulation goes on";
    EXPECT_EQ(seen.load(), recording->inputs.size()) << "who watches sees what is recorded, and no more";
    EXPECT_TRUE(was_whole.load());
    EXPECT_TRUE(was_before_the_end.load());
    const auto tick = runner.Latest().tick;
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > tick + 100; }));
    EXPECT_EQ(begun.load(), 1) << "nothing more is recorded";
    runner.Reset();
    ASSERT_TRUE(Eventually([&] { return begun.load() == 2; }));
  }
  EXPECT_EQ(ended.load(), 2);
  EXPECT_EQ(watched.load(), 2);
}

TEST_F(RunnerTest, GoesOnWhereAttemptsCannotBeKept) {
  Write("attempts", "a file where the folder should be");
  AttemptKeeping keeping{folder_ / "attempts", {}};
  keeping.description.name = (folder_ / "scene.json").string();
  auto simulation = MakeSimulation();
  ScriptSource source(simulation.GetScene());
  Runner runner(std::move(simulation), source, {.keeping = keeping});
  runner.SetPaused(false);
  ASSERT_TRUE(Eventually([&] { return runner.Latest().tick > 20; }));
  EXPECT_EQ(runner.RecordingStatus().value().failure.value().code, base::ErrorCode::kFileUnwritable);
}

// Slow motion changes when a tick runs, never what it computes; such an attempt is practice.
TEST(Runner, SlowMotionIsClamped) {
  auto scene = files::ReadTask(*files::FindTask("peg_transfer"));
  ASSERT_TRUE(scene.ok());
  auto simulation =
      simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(scene).value()));
  ASSERT_TRUE(simulation.ok());
  ScriptSource source(simulation->GetScene());
  Runner runner(std::move(simulation).value(), source);
  EXPECT_EQ(runner.GetSpeed(), 1.0);
  runner.SetSpeed(0.35);
  EXPECT_EQ(runner.GetSpeed(), 0.35);
  runner.SetSpeed(5);
  EXPECT_EQ(runner.GetSpeed(), 1.0);
  for (const double broken : {0.0, -1.0, std::nan("")}) {
    runner.SetSpeed(broken);
    EXPECT_EQ(runner.GetSpeed(), Runner::kSlowest);
  }
}

}  // namespace
}  // namespace trocar::session
