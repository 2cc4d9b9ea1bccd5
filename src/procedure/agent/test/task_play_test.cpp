// SPDX-License-Identifier: Apache-2.0
// Scripted surgeons do the delivered tasks: the able complete them, each careless one is caught.
#include "task_play.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "trocar/agent/hand_motion.h"
#include "trocar/agent/taking_over.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::agent {

using files::ListTasks;
using files::TaskEntry;
using instrument::kLeft;
using math::Vec3;
using scene::CalcScriptInput;
using scene::ErrorRule;
using scene::Goal;
using scene::ObjectSnapshot;
using scene::TaskPhase;
using simulation::InstrumentSnapshot;
using simulation::Simulation;

namespace {

std::vector<std::string> TasksWithoutPatient() {
  std::vector<std::string> keys;
  const auto tasks = ListTasks();
  if (!tasks.ok()) return keys;
  for (const TaskEntry& task : *tasks) {
    const auto scene = files::ReadTask(task.path);
    if (scene.ok() && !scene->HasPatient()) keys.push_back(task.key);
  }
  return keys;
}

class EveryTask : public testing::TestWithParam<std::string> {};

TEST_P(EveryTask, IsCompletedByTheExpertWithoutAnError) {
  const auto scene = ReadDelivered(GetParam());
  // the peg transfer takes the longest: one ring there and back shows what six do
  if (GetParam() == "peg_transfer")
    std::erase_if(scene->task->goals,
                  [](const Goal& goal) { return goal.name.find("Ring 4") == std::string::npos; });
  const auto played = PlayTask(scene, "expert", 1);
  ASSERT_TRUE(played.ok()) << played.error().Text();
  EXPECT_EQ(played->task.phase, TaskPhase::kCompleted) << "stopped at " << played->doing;
  EXPECT_EQ(played->task.error_count, 0u);
  EXPECT_GT(played->task.score, 50);
  EXPECT_FALSE(scene->task->goals.empty());
}

TEST_P(EveryTask, CatchesEachCarelessSurgeonAndOnlyByItsRule) {
  const auto scene = ReadDelivered(GetParam());
  int careless = 0;
  for (const SurgeonEntry& entry : ListSurgeons()) {
    if (!entry.suits(*scene) || *entry.error == 0 || std::string(entry.error) == "time_over") continue;
    ++careless;
    const double enough = GetParam() == "peg_transfer" ? 6 : 12;  // each errs early
    const auto played = PlayTask(scene, entry.name, 1, enough);
    ASSERT_TRUE(played.ok());
    EXPECT_GE(CountErrors(*scene, played->task, entry.error), 1u) << entry.name << " was not caught";
    // the same hands, judged without the rule
    auto lenient = std::make_shared<scene::Scene>(*scene);
    for (ErrorRule& rule : lenient->task->errors) {
      if (rule.name == entry.error) rule.when.clear();
    }
    const auto again = PlayTask(lenient, entry.name, 1, enough);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(CountErrors(*lenient, again->task, entry.error), 0u);
  }
  EXPECT_GE(careless, 1);
}

TEST_P(EveryTask, IsOverForWhoDawdlesAtTheLimitOnly) {
  auto scene = ReadDelivered(GetParam());
  scene->task->time_limit = 5;
  const auto played = PlayTask(scene, "dawdles", 1, 12);
  ASSERT_TRUE(played.ok());
  EXPECT_EQ(played->task.phase, TaskPhase::kTimeOver);
  EXPECT_EQ(played->task.score, 0);
  scene->task->time_limit = 30000;
  const auto again = PlayTask(scene, "dawdles", 1, 12);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->task.phase, TaskPhase::kRunning);
}

TEST_P(EveryTask, GivesTheSameHashAgainAndAnotherForAnotherSeed) {
  const auto play = [&](std::uint64_t seed) {
    const auto played = PlayTask(ReadDelivered(GetParam(), {"normal", seed, {}}), "expert", seed, 8);
    return played.ok() ? played->hash : 0;
  };
  const std::uint64_t hash = play(4);
  EXPECT_EQ(play(4), hash);
  EXPECT_NE(play(5), hash);
}

// Whoever takes over has never seen what was done before: a thing in a jaw, a tool on its way, a picture that was turned.
TEST_P(EveryTask, IsFinishedByWhoeverTakesOver) {
  const auto scene = ReadDelivered(GetParam());
  if (GetParam() == "peg_transfer")
    std::erase_if(scene->task->goals,
                  [](const Goal& goal) { return goal.name.find("Ring 4") == std::string::npos; });
  for (const double after : {1.5, 4.0, 7.5}) {
    auto simulation = Simulation::Make(scene);
    auto first = MakeSurgeon("expert", scene, 1);
    ASSERT_TRUE(simulation.ok() && first.ok());
    while (simulation->GetSnapshot().time < after) simulation->Step((*first)->Act(simulation->GetSnapshot()));
    const Vec3 tip = simulation->GetSnapshot().instruments[kLeft].X_world_device.translation;
    auto second = MakeSurgeonTakingOver("expert", *scene, simulation->GetSnapshot(), 2);
    ASSERT_TRUE(second.ok()) << second.error().Text();
    simulation->Step((*second)->Act(simulation->GetSnapshot()));
    EXPECT_LT(math::Distance(simulation->GetSnapshot().instruments[kLeft].X_world_device.translation, tip),
              5e-4)
        << "a hand does not jump";
    while (!(*second)->HasFinished() && simulation->GetSnapshot().time < 400)
      simulation->Step((*second)->Act(simulation->GetSnapshot()));
    EXPECT_EQ(simulation->GetSnapshot().task.phase, TaskPhase::kCompleted)
        << "taken over after " << after << " s, stopped at " << (*second)->Doing();
    EXPECT_EQ(simulation->GetSnapshot().task.error_count, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Tasks, EveryTask, testing::ValuesIn(TasksWithoutPatient()),
                         [](const auto& one) { return one.param; });

TEST(Docs, TheTaskThatIsShownInFullWorks) {
  const auto page = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / "docs/tasks.md");
  ASSERT_TRUE(page.ok());
  const std::size_t begin = page->find("```json\n"), end = page->find("```", begin + 8);
  ASSERT_NE(end, std::string::npos);
  const test::TemporaryFolder folder;
  const auto file = folder.Path() / "cube.json";
  ASSERT_TRUE(host::WriteFile(file, page->substr(begin + 8, end - begin - 8)).ok());
  for (const char* level : {"easy", "normal"}) {
    auto scene = files::ReadTask(file, {level, 2, {}});
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    const auto played = PlayTask(std::make_shared<scene::Scene>(std::move(*scene)), "expert", 2);
    ASSERT_TRUE(played.ok());
    EXPECT_EQ(played->task.phase, TaskPhase::kCompleted) << played->doing;
    EXPECT_EQ(played->task.error_count, 0u);
  }
}

TEST(Novice, IsSlowerThanTheExpertAndStillArrives) {
  const auto scene = ReadDelivered("object_transport");
  const auto expert = PlayTask(scene, "expert", 1), novice = PlayTask(scene, "novice", 1);
  ASSERT_TRUE(expert.ok() && novice.ok());
  EXPECT_EQ(novice->task.phase, TaskPhase::kCompleted) << novice->doing;
  EXPECT_GT(novice->task.time, 2 * expert->task.time);
  EXPECT_LT(novice->task.score, expert->task.score);
}

TEST(Surgeons, AreRefusedWhereTheyDoNotSuit) {
  const auto scene = ReadDelivered("camera_navigation_0");
  const auto made = MakeSurgeon("touches_wire", scene, 1);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kUnknownName);
  EXPECT_NE(made.error().Text().find("smears_lens"), std::string::npos) << made.error().Text();
}

/// The left hand takes the first bar of the transport, by hand-made inputs.
TEST(RigidThings, AreHeldFeltPublishedAndReset) {
  const auto scene = ReadDelivered("object_transport");
  auto made = Simulation::Make(scene);
  ASSERT_TRUE(made.ok());
  Simulation simulation = std::move(*made);
  const std::uint64_t start = simulation.Hash();
  const math::Vec3 bar = simulation.GetSnapshot().objects[0].X_world_object.translation;
  const math::Vec3& port = scene->instruments[kLeft].p_world_port;
  scene::Input input = CalcScriptInput(*scene, 0);
  // a reach in small steps, as a hand makes it
  const auto reach = [&](const math::Vec3& to, double jaw, double seconds) {
    const math::Vec3 from = simulation.GetSnapshot().instruments[kLeft].X_world_device.translation;
    const int ticks = static_cast<int>(seconds * 120);
    for (int tick = 1; tick <= ticks; ++tick) {
      const math::Vec3 tip = math::Lerp(from, to, static_cast<double>(tick) / ticks);
      input.hands[kLeft] = instrument::FindJoints(port, tip, FindSpin(port, tip, {1, 0, 0}), jaw);
      simulation.Step(input);
    }
  };
  const auto& left = simulation.GetSnapshot().instruments[kLeft];
  reach(bar + Vec3{0, -0.004, 0.030}, 0.63, 0.5);
  reach(bar + Vec3{0, -0.004, 0}, 0.63, 0.4);
  EXPECT_EQ(left.object, -1);
  reach(bar + Vec3{0, -0.004, 0}, 0.0, 0.5);
  ASSERT_EQ(left.object, 0);
  EXPECT_TRUE(left.is_grasping);
  EXPECT_GT(left.joints.jaw, 0.2) << "the jaws stop at the bar";
  EXPECT_GT(left.pinch, 15) << "squeezed as far as they go";
  reach(bar + Vec3{0, -0.004, 0.050}, 0.0, 0.8);
  reach(bar + Vec3{0, -0.004, 0.050}, 0.0, 0.4);
  const ObjectSnapshot& held = simulation.GetSnapshot().objects[0];
  EXPECT_EQ(held.held_by, 1);
  EXPECT_NEAR(held.X_world_object.translation.z, bar.z + 0.050, 0.003);
  EXPECT_NEAR(left.force.z, -0.003 * 9.81, 0.01) << "it weighs what it weighs";
  reach(bar + Vec3{0, -0.004, 0.050}, 1.0, 0.3);
  EXPECT_EQ(left.object, -1);
  reach(bar + Vec3{0, -0.004, 0.050}, 1.0, 0.7);
  EXPECT_LT(simulation.GetSnapshot().objects[0].X_world_object.translation.z, bar.z + 0.010)
      << "let go, it falls";
  simulation.Reset();
  EXPECT_EQ(simulation.Hash(), start);
}

TEST(RigidThings, ABoardPushesBackAndKeepsTheSeenToolOut) {
  const auto scene = ReadDelivered("instrument_navigation");
  auto made = Simulation::Make(scene);
  ASSERT_TRUE(made.ok());
  scene::Input input = CalcScriptInput(*scene, 0);
  const math::Vec3& port = scene->instruments[kLeft].p_world_port;
  for (int tick = 0; tick < 240; ++tick) {
    const double z = -0.095 - std::min(1.0, tick / 120.0) * 0.050;  // 5 mm below the board's top at -140 mm
    input.hands[kLeft] = instrument::FindJoints(port, {-0.030, 0.010, z}, 0, 0);
    made->Step(input);
  }
  const InstrumentSnapshot& left = made->GetSnapshot().instruments[kLeft];
  EXPECT_NEAR(left.X_world_device.translation.z, -0.145, 1e-4);
  EXPECT_GT(left.X_world_tool.translation.z, -0.1395) << "a jaw is 1.5 mm thick";
  EXPECT_GT(left.force.z, 1.5);
  EXPECT_EQ(made->GetSnapshot().objects[0].touched_by, 1);
}

}  // namespace
}  // namespace trocar::agent
