// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <new>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "allocation_counter.h"
#include "small_scene.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/threads.h"

namespace trocar::simulation {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::CalcScriptInput;
using scene::Input;
using scene::Scene;
using scene::SmallScene;
using surgery::FactKind;
using surgery::FactName;

namespace {

class SimulationTest : public SmallScene {
 protected:
  Simulation Make(int threads = 1) {
    auto scene = Read();
    EXPECT_TRUE(scene.ok()) << scene.error().Text();
    scene_ = std::make_shared<const Scene>(std::move(*scene));
    auto simulation = Simulation::Make(scene_, {.threads = test::UseThreads(threads)});
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
  std::set<FactKind> seen;
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
  EXPECT_TRUE(seen.count(FactKind::kGrasp));
  EXPECT_TRUE(seen.count(FactKind::kRelease));
  EXPECT_FALSE(seen.count(FactKind::kStateRestored));
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

// What is asked between two ticks has the same answer in a simulation that was just restored.
TEST_F(SimulationTest, ARestoredSimulationHasItsLoadBeforeTheNextTick) {
  Simulation simulation = Make();
  Input input = CalcScriptInput(*scene_, 0.0);
  input.settings.gravity = 5.0;
  input.settings.stiffness_scale = 1.5;
  std::size_t contacts = 0;
  for (int i = 0; i < 400 && contacts == 0; ++i) {
    input.hands = CalcScriptInput(*scene_, simulation.GetSnapshot().time).hands;
    simulation.Step(input);
    contacts = simulation.GetSnapshot().contacts;
  }
  ASSERT_GT(contacts, 0u);
  for (int i = 0; i < 5; ++i) simulation.Step(input);
  std::vector<std::byte> bytes;
  simulation.Save(bytes);
  Simulation other = Make();
  ASSERT_TRUE(other.Restore(bytes).ok());
  EXPECT_EQ(other.CalcEquilibriumError(), simulation.CalcEquilibriumError());
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

// The hand goes into the gallbladder; the tool that is seen does not.
TEST_F(SimulationTest, ToolThatIsSeenStaysOutsideOfTissue) {
  Simulation simulation = Make();
  Input input = CalcScriptInput(*scene_, 0.0);
  const auto& setup = scene_->instruments[kLeft];
  const Vec3 fundus{0, 0.056, -0.107};
  double deepest = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 tip = fundus + Vec3{0, 0, 0.012 - 0.0004 * i};
    input.hands[kLeft] = instrument::FindJoints(setup.p_world_port, tip, 0.0, 0.0);
    simulation.Step(input);
    const InstrumentSnapshot& tool = simulation.GetSnapshot().instruments[kLeft];
    EXPECT_LT(tool.overlap, 2e-4) << i;
    deepest =
        std::max(deepest, math::Distance(tool.X_world_device.translation, tool.X_world_tool.translation));
  }
  const InstrumentSnapshot& tool = simulation.GetSnapshot().instruments[kLeft];
  EXPECT_EQ(tool.organ, 1);
  EXPECT_GT(math::Norm(tool.force), 0.01);
  EXPECT_GT(deepest, 1e-4);
}

TEST_F(SimulationTest, DuctsAreGraspedAndNamed) {
  Simulation simulation = Make();
  Input input = CalcScriptInput(*scene_, 0.0);
  const auto& setup = scene_->instruments[kRight];
  const auto& duct = simulation.Surfaces()[2];
  ASSERT_EQ(duct.name, "cystic_duct");
  const std::uint32_t node = duct.first_node + duct.node_count / 2;
  const Vec3 at = simulation.GetSnapshot().positions[node];
  const auto move = [&](const Vec3& tip, double jaw, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      input.hands[kRight] = instrument::FindJoints(setup.p_world_port, tip, 0.0, jaw);
      simulation.Step(input);
    }
  };
  move(at + Vec3{0, 0, 0.012}, 0.8, 40);
  move(at + Vec3{0, 0, 0.001}, 0.8, 20);
  move(at + Vec3{0, 0, 0.001}, 0.05, 20);
  const InstrumentSnapshot& tool = simulation.GetSnapshot().instruments[kRight];
  ASSERT_TRUE(tool.is_grasping);
  EXPECT_EQ(tool.organ, 2) << "organs first, then tubes";
  EXPECT_GT(tool.pinch, 3.0);
  move(at + Vec3{0, 0, 0.008}, 0.05, 30);
  EXPECT_GT(simulation.GetSnapshot().positions[node].z, at.z + 0.002) << "the duct comes along";
}

TEST_F(SimulationTest, ToolsThatMeetSaySoAndPushBack) {
  Simulation simulation = Make();
  Input input = CalcScriptInput(*scene_, 0.0);
  const Vec3 meeting{0, 0.03, -0.06};
  bool is_met = false;
  for (int i = 0; i <= 60; ++i) {
    const double apart = 0.02 * (60 - i) / 60;
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      // each tip goes past the other's shaft
      const Vec3 side{hand == kLeft ? 0.01 : -0.01, hand == kLeft ? apart : -apart, 0};
      input.hands[hand] =
          instrument::FindJoints(scene_->instruments[hand].p_world_port, meeting + side, 0.0, 0.0);
    }
    simulation.Step(input);
    is_met = is_met || simulation.GetSnapshot().instruments[kLeft].is_touching_tool;
  }
  EXPECT_TRUE(is_met);
  const Snapshot& now = simulation.GetSnapshot();
  bool is_said = false;
  for (const scene::Event& event : now.events)
    is_said = is_said || (event.kind == FactKind::kToolsTouch && event.tick > 0);
  EXPECT_TRUE(is_said);
  EXPECT_GT(math::Norm(now.instruments[kLeft].force), 0.1);
}

TEST_F(SimulationTest, MissingMaterialIsNamed) {
  auto scene = Read();
  ASSERT_TRUE(scene.ok());
  scene->materials.erase(scene->materials.begin() + 1);
  const auto simulation = Simulation::Make(std::make_shared<const Scene>(std::move(*scene)));
  ASSERT_FALSE(simulation.ok());
  EXPECT_EQ(simulation.error().code, base::ErrorCode::kSceneInvalid);
  EXPECT_NE(simulation.error().message.find("gallbladder"), std::string::npos);
}

// The map of the step names the stages in the order in which they run.
TEST(StageName, IsThatOfTheMapInTheDocuments) {
  const auto page = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / "docs/step.md");
  ASSERT_TRUE(page.ok());
  std::vector<std::string> stages;
  std::istringstream lines(*page);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) == 0) stages.push_back(line.substr(3, line.find('`', 3) - 3));
  }
  ASSERT_EQ(stages.size(), static_cast<std::size_t>(kStageCount));
  for (int i = 0; i < kStageCount; ++i)
    EXPECT_EQ(stages[static_cast<std::size_t>(i)], StageName(static_cast<Stage>(i))) << i;
}

TEST(StageName, HasANameForEachStageAndEvent) {
  std::set<std::string_view> names;
  for (int i = 0; i < kStageCount; ++i) EXPECT_TRUE(names.insert(StageName(static_cast<Stage>(i))).second);
  for (int i = 0; i <= static_cast<int>(FactKind::kToolsTouch); ++i) {
    EXPECT_TRUE(names.insert(FactName(static_cast<FactKind>(i))).second);
  }
}

}  // namespace
}  // namespace trocar::simulation
