// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/replay_runner.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "small_scene.h"
#include "trocar/record/recorder.h"

namespace trocar::session {
namespace {

using simulation::Simulation;

constexpr std::uint64_t kTicks = 1200;

class ReplayRunnerTest : public scene::SmallScene {
 protected:
  void SetUp() override {
    SmallScene::SetUp();
    auto read = Read();
    ASSERT_TRUE(read.ok());
    const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
    auto simulation = Simulation::Make(scene);
    ASSERT_TRUE(simulation.ok());
    record::Description description;
    description.name = (folder_ / "scene.json").string();
    description.seed = scene->seed;
    record::RecorderSettings settings;
    settings.waits = true;
    auto recorder = record::Recorder::Start(folder_ / "a.trocar", description, *simulation, settings);
    ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
    hashes_.push_back(simulation->Hash());
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      const auto input = scene::CalcScriptInput(*scene, 0.3 * simulation->GetSnapshot().time);
      simulation->Step(input);
      (*recorder)->Add(input, *simulation);
      hashes_.push_back(simulation->Hash());
    }
    ASSERT_TRUE((*recorder)->Finish(*simulation).ok());
  }
  record::Replay OpenReplay() {
    auto recording = record::ReadRecording(folder_ / "a.trocar");
    EXPECT_TRUE(recording.ok());
    auto replay = record::Replay::Open(std::move(*recording), 1);
    EXPECT_TRUE(replay.ok()) << replay.error().Text();
    return std::move(*replay);
  }
  static bool Eventually(const std::function<bool()>& claim) {
    // what is learnt beside the play waits for a processor that has nothing else to do
    for (int i = 0; i < 24'000; ++i) {
      if (claim()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  std::vector<std::uint64_t> hashes_;
};

TEST_F(ReplayRunnerTest, ComesToWhereItIsWanted) {
  ReplayRunner runner(OpenReplay(), {0});
  EXPECT_EQ(runner.Latest().tick, 0u);
  EXPECT_TRUE(runner.Status().is_there);
  for (const std::uint64_t tick : {700, 30, 1199, 5000, 0}) {
    runner.SeekTo(tick);
    ASSERT_TRUE(Eventually([&] { return runner.Status().is_there; }));
    EXPECT_EQ(runner.Latest().tick, std::min(tick, kTicks));
    EXPECT_DOUBLE_EQ(runner.Status().progress, 1);
  }
}

TEST_F(ReplayRunnerTest, TheNewestWishWins) {
  ReplayRunner runner(OpenReplay(), {0});
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) runner.SeekTo(tick % 2 == 0 ? tick : kTicks - tick);
  runner.SeekTo(17);
  ASSERT_TRUE(Eventually([&] { return runner.Status().is_there; }));
  EXPECT_EQ(runner.Status().tick, 17u);
  EXPECT_EQ(runner.Latest().tick, 17u);
}

TEST_F(ReplayRunnerTest, BranchesWhereItIsAskedToAndStaysThere) {
  ReplayRunner runner(OpenReplay(), {0});
  EXPECT_FALSE(runner.TakeBranch());
  runner.AskForBranch(333, 1);
  std::optional<base::Result<Simulation>> branch;
  ASSERT_TRUE(Eventually([&] { return (branch = runner.TakeBranch()).has_value(); }));
  ASSERT_TRUE(branch->ok()) << branch->error().Text();
  EXPECT_EQ((*branch)->Hash(), hashes_[333]);
  EXPECT_FALSE(runner.TakeBranch()) << "once";
  EXPECT_EQ(runner.Latest().tick, 333u);
  // neither disturbs the other
  (*branch)->Step({});
  runner.SeekTo(334);
  ASSERT_TRUE(Eventually([&] { return runner.Status().is_there; }));
  EXPECT_NE((*branch)->Hash(), hashes_[334]);
}

TEST_F(ReplayRunnerTest, LearnsTheWholeRecordingWhileItIsLookedAt) {
  ReplayRunner runner(OpenReplay(), {0.5});
  ASSERT_TRUE(Eventually([&] { return runner.Status().known_share > 0.999; }));
  runner.SeekTo(1190);
  ASSERT_TRUE(Eventually([&] { return runner.Status().is_there; }));
  EXPECT_EQ(runner.Latest().tick, 1190u);
  EXPECT_FALSE(runner.Status().divergence);
}

TEST_F(ReplayRunnerTest, EndsInTheMiddleOfASeek) {
  for (int i = 0; i < 5; ++i) {
    ReplayRunner runner(OpenReplay());
    runner.SeekTo(kTicks);
  }
}

}  // namespace
}  // namespace trocar::session
