// SPDX-License-Identifier: Apache-2.0
// A simulation that begins with its hands elsewhere, and the list of its contacts.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "trocar/files/find_scene.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {
namespace {

struct Started {
  std::shared_ptr<const scene::Scene> scene;
  Simulation simulation;
  scene::Input input;
};

Started Make(const std::string& task) {
  auto read = files::FindScene(task);
  EXPECT_TRUE(read.ok());
  auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = Simulation::Make(scene);
  EXPECT_TRUE(simulation.ok());
  return {scene, std::move(*simulation), scene::CalcScriptInput(*scene, 0)};
}

TEST(OtherStart, TakesHandsAndLensThereAndNothingElse) {
  for (const char* task : {"peg_transfer", "clip_and_cut", "cholecystectomy"}) {
    SCOPED_TRACE(task);
    Started one = Make(task);
    const std::uint64_t home = one.simulation.Hash();
    const Snapshot before = one.simulation.GetSnapshot();
    scene::Input start = one.input;
    start.hands[0].pan += 0.04;
    start.hands[1].depth -= 0.004;
    start.laparoscope.tilt += 0.03;
    for (int i = 0; i < 5; ++i) one.simulation.Step(one.input);
    one.simulation.Reset(start);
    const Snapshot& now = one.simulation.GetSnapshot();
    EXPECT_EQ(now.tick, 0u);
    EXPECT_EQ(now.positions, before.positions);
    EXPECT_EQ(now.instruments[0].joints.pan, start.hands[0].pan);
    EXPECT_GT(math::Distance(now.instruments[0].X_world_tool.translation,
                             before.instruments[0].X_world_tool.translation),
              0.001);
    EXPECT_GT(math::Distance(now.X_world_laparoscope.translation, before.X_world_laparoscope.translation),
              0.001);
    for (std::size_t i = 0; i < now.objects.size(); ++i)
      EXPECT_EQ(now.objects[i].X_world_object.translation, before.objects[i].X_world_object.translation);
    // whoever holds still has not begun
    start.settings = one.input.settings;
    for (int i = 0; i < 3; ++i) one.simulation.Step(start);
    if (one.scene->task) {
      EXPECT_EQ(one.simulation.GetSnapshot().task.phase, scene::TaskPhase::kReady);
    }
    const std::uint64_t there = one.simulation.Hash();
    one.simulation.Reset(start);
    for (int i = 0; i < 3; ++i) one.simulation.Step(start);
    EXPECT_EQ(one.simulation.Hash(), there) << "the same start, the same bits";
    one.simulation.Reset();
    EXPECT_EQ(one.simulation.Hash(), home);
  }
}

// The board keeps a tool out that leans on it: its contact says where, and how strongly.
TEST(ToolContacts, OfABoardAddUpToTheForce) {
  Started one = Make("peg_transfer");
  std::vector<ToolContact> contacts;
  one.simulation.FindToolContacts(contacts);
  EXPECT_TRUE(contacts.empty());
  for (int i = 0; i < 100; ++i) {
    one.input.hands[0].depth += 0.0008;
    one.simulation.Step(one.input);
  }
  one.simulation.FindToolContacts(contacts);
  ASSERT_FALSE(contacts.empty());
  const std::uint64_t before = one.simulation.Hash();
  for (const ToolContact& contact : contacts) {
    EXPECT_EQ(contact.hand, 0);
    EXPECT_EQ(contact.surface, -1);
    EXPECT_EQ(one.scene->objects[static_cast<std::size_t>(contact.object)].name, "board");
    EXPECT_GT(contact.normal.z, 0.9);
    EXPECT_GT(math::Dot(contact.force, contact.normal), 0);
    EXPECT_NEAR(contact.point.z, -0.140, 0.004);
  }
  EXPECT_EQ(one.simulation.Hash(), before) << "looking changes nothing";
}

}  // namespace
}  // namespace trocar::simulation
