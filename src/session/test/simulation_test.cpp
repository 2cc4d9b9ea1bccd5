// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <new>
#include <set>

#include "allocation_counter.h"
#include "small_scene.h"

namespace trocar::session {
namespace {

class SimulationTest : public SmallScene {
 protected:
  Simulation Make(int threads = 1) {
    auto scene = Read();
    EXPECT_TRUE(scene.ok()) << scene.error().Text();
    scene_ = std::make_shared<const Scene>(std::move(*scene));
    auto simulation = Simulation::Make(scene_, threads);
    EXPECT_TRUE(simulation.ok()) << simulation.error().Text();
    return std::move(*simulation);
  }
  void Play(Simulation& simulation, int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.Step(CalcScriptInput(*scene_, simulation.GetSnapshot().time));
  }
  std::shared_ptr<const Scene> scene_;
};

TEST_F(SimulationTest, LiesStillWhenNothingActs) {
  Simulation simulation = Make();
  const auto rest = simulation.GetSnapshot().positions;
  Input input = CalcScriptInput(*scene_, 0.0);
  input.hands = {scene_->instruments[0].home, scene_->instruments[1].home};
  for (int i = 0; i < 20; ++i) simulation.Step(input);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    ASSERT_NEAR(math::Distance(simulation.GetSnapshot().positions[i], rest[i]), 0.0, 1e-9) << i;
  }
}

TEST_F(SimulationTest, ScriptGraspsLiftsAndLetsGo) {
  Simulation simulation = Make();
  const auto rest = simulation.GetSnapshot().positions;
  std::set<EventKind> seen;
  double highest_force = 0, largest = 0;
  std::uint64_t events = 0;
  for (int i = 0; i < 180; ++i) {
    Play(simulation, 1);
    const Snapshot& now = simulation.GetSnapshot();
    for (; events < now.event_count; ++events) seen.insert(now.events[events % now.events.size()].kind);
    highest_force = std::max(highest_force, math::Norm(now.instruments[kLeft].force));
    for (std::size_t node = 0; node < rest.size(); ++node) {
      largest = std::max(largest, math::Distance(now.positions[node], rest[node]));
    }
    EXPECT_EQ(math::Norm(now.instruments[kRight].force), 0.0);
  }
  EXPECT_TRUE(seen.count(EventKind::kGrasp));
  EXPECT_TRUE(seen.count(EventKind::kRelease));
  EXPECT_FALSE(seen.count(EventKind::kStateRestored));
  EXPECT_GT(largest, 0.004);
  EXPECT_GT(highest_force, 0.05);
  EXPECT_LT(highest_force, 30.0);
}

TEST_F(SimulationTest, SameInputsGiveTheSameBitsForAnyNumberOfThreads) {
  const auto hash = [&](int threads) {
    Simulation simulation = Make(threads);
    Play(simulation, 150);
    return simulation.Hash();
  };
  const auto one = hash(1);
  EXPECT_EQ(hash(1), one);
  EXPECT_EQ(hash(2), one);
  EXPECT_EQ(hash(4), one);
}

TEST_F(SimulationTest, ResetStartsTheSameSurgeryAgain) {
  Simulation simulation = Make();
  const auto at_start = simulation.Hash();
  Play(simulation, 100);
  const auto first = simulation.Hash();
  EXPECT_NE(first, at_start);
  simulation.Reset();
  EXPECT_EQ(simulation.Hash(), at_start);
  Play(simulation, 100);
  EXPECT_EQ(simulation.Hash(), first);
}

TEST_F(SimulationTest, TickAllocatesNothing) {
  Simulation simulation = Make();
  Play(simulation, 60);
  const Input input = CalcScriptInput(*scene_, 0.5);
  const long before = CountAllocations();
  for (int i = 0; i < 60; ++i) simulation.Step(input);
  EXPECT_EQ(CountAllocations() - before, 0);
  const long control = CountAllocations();
  ::operator delete(::operator new(8));
  EXPECT_GT(CountAllocations(), control) << "the counter counts";
}

TEST_F(SimulationTest, TiltOfTheTableMovesOrgansDownhillAndBack) {
  Simulation simulation = Make();
  const auto rest = simulation.GetSnapshot().positions;
  const auto& gallbladder = simulation.Surfaces()[1];
  Input input = CalcScriptInput(*scene_, 0.0);
  const auto mean_shift = [&] {
    Vec3 sum;
    for (std::uint32_t i = 0; i < gallbladder.node_count; ++i) {
      sum +=
          simulation.GetSnapshot().positions[gallbladder.first_node + i] - rest[gallbladder.first_node + i];
    }
    return sum / gallbladder.node_count;
  };
  input.settings.right_up = 0.3;
  for (int i = 0; i < 200; ++i) simulation.Step(input);
  EXPECT_GT(mean_shift().x, 1e-5) << "right side up: the gallbladder falls to the left";
  input.settings.right_up = 0.0;
  for (int i = 0; i < 400; ++i) simulation.Step(input);
  EXPECT_LT(math::Norm(mean_shift()), 2e-6);
}

TEST_F(SimulationTest, SurvivesNanAndWildInputs) {
  Simulation simulation = Make();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Input wild = CalcScriptInput(*scene_, 0.0);
  wild.hands[0] = {nan, nan, nan, nan, nan};
  wild.hands[1] = {1e9, -1e9, 1e9, 1e9, 1e9};
  wild.laparoscope = {nan, 1e300, nan, -1, 0};
  wild.settings.gravity = nan;
  wild.settings.stiffness_scale = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100; ++i) {
    simulation.Step(i % 2 ? wild : CalcScriptInput(*scene_, 0.5));
    for (const Vec3& p : simulation.GetSnapshot().positions) ASSERT_TRUE(math::IsFinite(p)) << i;
    for (const auto& tool : simulation.GetSnapshot().instruments)
      ASSERT_TRUE(math::IsFinite(tool.force)) << i;
    ASSERT_TRUE(math::IsFinite(simulation.GetSnapshot().X_world_laparoscope.translation));
  }
}

// A device that jumps 50 mm must not move the tool faster than a hand can.
TEST_F(SimulationTest, SlowsAJumpOfTheDevice) {
  Simulation simulation = Make();
  Input input = CalcScriptInput(*scene_, 0.0);
  simulation.Step(input);
  const Vec3 before = simulation.GetSnapshot().instruments[kRight].X_world_tool.translation;
  input.hands[kRight].depth += 0.05;
  simulation.Step(input);
  const Vec3 after = simulation.GetSnapshot().instruments[kRight].X_world_tool.translation;
  EXPECT_LE(math::Distance(before, after), 2.0 / 120 + 1e-9);
  EXPECT_GT(math::Distance(before, after), 0.01);
}

TEST_F(SimulationTest, MissingMaterialIsNamed) {
  auto scene = Read();
  ASSERT_TRUE(scene.ok());
  scene->materials.erase(scene->materials.begin() + 1);
  const auto simulation = Simulation::Make(std::make_shared<const Scene>(std::move(*scene)), 1);
  ASSERT_FALSE(simulation.ok());
  EXPECT_EQ(simulation.error().code, core::ErrorCode::kSceneInvalid);
  EXPECT_NE(simulation.error().message.find("gallbladder"), std::string::npos);
}

TEST(StageName, HasANameForEachStageAndEvent) {
  std::set<std::string_view> names;
  for (int i = 0; i < kStageCount; ++i) EXPECT_TRUE(names.insert(StageName(static_cast<Stage>(i))).second);
  for (int i = 0; i <= static_cast<int>(EventKind::kToolsTouch); ++i) {
    EXPECT_TRUE(names.insert(EventName(static_cast<EventKind>(i))).second);
  }
}

}  // namespace
}  // namespace trocar::session
