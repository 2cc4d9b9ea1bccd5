// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/demonstration.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/environment/environment.h"
#include "trocar/math/random.h"
#include "trocar/scene/task.h"

namespace trocar::environment {
namespace {

// what an action did to the hands says which action it was
TEST(Demonstration, FindsTheActionThatWasTaken) {
  for (const char* task : {"lift_and_grasp", "clip_and_cut", "camera_navigation_30"}) {
    for (const ActionKind kind : {ActionKind::kJoints, ActionKind::kTip}) {
      auto model = EnvironmentModel::Make({.task = task, .actions = kind});
      ASSERT_TRUE(model.ok());
      auto environment = Environment::Make(*model);
      ASSERT_TRUE(environment.ok() && environment->Reset(1).ok());
      const Demonstration demonstration(environment->GetSimulation());
      ASSERT_EQ(demonstration.ActionSize(kind), (*model)->ActionSize());
      const double seconds =
          (*model)->TicksPerAction() * environment->GetSimulation().GetScene().tick_seconds;
      math::Random random(2);
      std::vector<double> action((*model)->ActionSize()), found(action.size());
      for (int step = 0; step < 5; ++step) {
        for (const Field& field : (*model)->ActionFields()) {
          // jaws begin closed: they only open, or their limit would cut the action; a pedal is on or off
          const bool opens = field.name.ends_with(".jaw");
          double value = random.Uniform(opens ? 0.01 : -0.3, opens ? 0.1 : 0.3);
          if (field.unit == "-") value = field.name.ends_with(".tool") ? -0.99 : value > 0 ? 1 : -1;
          action[field.first] = value;
        }
        const scene::Input before = environment->LastInput();
        ASSERT_TRUE(environment->Step(action).ok());
        demonstration.FindAction(kind, before, environment->LastInput(), seconds, found);
        for (const Field& field : (*model)->ActionFields()) {
          if (field.name.ends_with(".tool")) continue;  // any number of a part is that tool
          EXPECT_NEAR(found[field.first], action[field.first], 1e-6)
              << task << " " << NameOf(kind) << " " << field.name;
        }
      }
    }
  }
}

// a tool and a command are found again by their part of -1 to 1
TEST(Demonstration, FindsToolsAndCommands) {
  auto model = EnvironmentModel::Make({.task = "cholecystectomy", .actions = ActionKind::kTip});
  ASSERT_TRUE(model.ok());
  auto environment = Environment::Make(*model);
  ASSERT_TRUE(environment.ok() && environment->Reset(1).ok());
  const Demonstration demonstration(environment->GetSimulation());
  const scene::Input before = environment->LastInput();
  scene::Input after = before;
  after.controls[1].tool = 2;
  after.controls[1].coagulate = true;
  after.assistant = scene::AssistantCommand::kRelax;
  std::vector<double> action((*model)->ActionSize());
  demonstration.FindAction(ActionKind::kTip, before, after, 0.1, action);
  ASSERT_TRUE((*model)->CheckAction(action).ok());
  ASSERT_TRUE(environment->Step(action).ok());
  EXPECT_EQ(environment->LastInput().controls[1].tool, 2);
  EXPECT_TRUE(environment->LastInput().controls[1].coagulate);
  EXPECT_FALSE(environment->LastInput().controls[1].cut);
  EXPECT_EQ(environment->LastInput().assistant, scene::AssistantCommand::kRelax);
}

TEST(Demonstration, ObservesWhatAnEnvironmentObserves) {
  auto model = EnvironmentModel::Make({.task = "peg_transfer"});
  ASSERT_TRUE(model.ok());
  auto environment = Environment::Make(*model);
  ASSERT_TRUE(environment.ok() && environment->Reset(1).ok());
  ASSERT_TRUE(environment->Step(std::vector<double>((*model)->ActionSize(), 0.5)).ok());
  const Demonstration demonstration(environment->GetSimulation());
  ASSERT_EQ(demonstration.StateSize(), environment->StateSize());
  std::vector<float> seen(demonstration.StateSize()), wanted(seen.size());
  demonstration.Observe(environment->GetSimulation(), seen);
  environment->Observe(wanted);
  EXPECT_EQ(seen, wanted);
}

}  // namespace
}  // namespace trocar::environment
