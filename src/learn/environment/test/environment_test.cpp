// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/environment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include "reward.h"
#include "trocar/agent/surgeon.h"
#include "trocar/files/task_file.h"
#include "trocar/math/random.h"
#include "trocar/scene/task.h"

namespace trocar::environment {
namespace {

std::shared_ptr<EnvironmentModel> MakeModel(const EnvironmentSettings& settings) {
  auto made = EnvironmentModel::Make(settings);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().Text());
  return made.ok() ? *made : nullptr;
}

Environment MakeEnvironment(const EnvironmentSettings& settings) {
  auto made = Environment::Make(MakeModel(settings));
  EXPECT_TRUE(made.ok());
  return std::move(*made);
}

std::vector<double> DrawAction(const EnvironmentModel& model, math::Random& random) {
  std::vector<double> action;
  for (const Field& field : model.ActionFields()) {
    action.push_back(field.choices == 0 ? random.Uniform(-1, 1)
                                        : std::floor(random.Uniform() * static_cast<double>(field.choices)));
  }
  return action;
}

TEST(Environment, SameSeedAndActionsGiveTheSameBits) {
  for (const ActionKind kind : {ActionKind::kJoints, ActionKind::kTip, ActionKind::kDiscrete}) {
    std::array<std::uint64_t, 2> hashes{};
    std::array<double, 2> rewards{};
    const auto model = MakeModel({.task = "lift_and_grasp", .layouts = 3, .actions = kind});
    for (int run = 0; run < 2; ++run) {
      Environment environment = std::move(*Environment::Make(model));
      // what was before must not matter
      if (run == 1) {
        ASSERT_TRUE(environment.Reset(99).ok());
      }
      ASSERT_TRUE(environment.Reset(5).ok());
      math::Random random(3);
      for (int i = 0; i < 20; ++i) {
        const auto outcome = environment.Step(DrawAction(*model, random));
        ASSERT_TRUE(outcome.ok()) << outcome.error().Text();
        rewards[run] += outcome->reward;
      }
      hashes[run] = environment.GetSimulation().Hash();
    }
    EXPECT_EQ(hashes[0], hashes[1]) << NameOf(kind);
    EXPECT_EQ(rewards[0], rewards[1]) << NameOf(kind);
  }
}

TEST(Environment, SeedsChooseLayouts) {
  const auto model = MakeModel({.task = "lift_and_grasp", .layouts = 8});
  Environment environment = std::move(*Environment::Make(model));
  std::vector<float> one(model->StateSize()), other(model->StateSize());
  ASSERT_TRUE(environment.Reset(1).ok());
  const std::uint64_t layout = environment.Layout();
  environment.Observe(one);
  std::uint64_t seed = 2;
  do {
    ASSERT_TRUE(environment.Reset(seed++).ok());
  } while (environment.Layout() == layout && seed < 100);
  environment.Observe(other);
  EXPECT_NE(one, other);
  ASSERT_TRUE(environment.Reset(1).ok());
  environment.Observe(other);
  EXPECT_EQ(one, other);
}

// Every seed has its own layout and start; the row of episodes that nobody names has, too.
TEST(Environment, EverySeedIsAStartOfItsOwn) {
  const auto model = MakeModel({.task = "peg_transfer"});
  Environment environment = std::move(*Environment::Make(model)),
              other = std::move(*Environment::Make(model));
  std::vector<float> state(model->StateSize()), again(state.size());
  std::set<std::vector<float>> starts;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ASSERT_TRUE(environment.Reset(seed).ok());
    EXPECT_EQ(environment.EpisodeSeed(), seed);
    EXPECT_EQ(environment.Layout(), seed);
    environment.Observe(state);
    starts.insert(state);
    ASSERT_TRUE(environment.Reset().ok());
    environment.Observe(state);
    starts.insert(state);
    ASSERT_TRUE(other.Reset(environment.EpisodeSeed()).ok());
    other.Observe(again);
    EXPECT_EQ(state, again);
  }
  EXPECT_EQ(starts.size(), 40u);
}

TEST(Environment, IsSavedWithWhatItHasDrawn) {
  const auto model = MakeModel({.task = "lift_and_grasp", .actions = ActionKind::kTip});
  Environment environment = std::move(*Environment::Make(model)),
              other = std::move(*Environment::Make(model));
  Ranges ranges = UsualRanges();
  ranges[static_cast<std::size_t>(Varied::kLatency)] = {0.03, 0.2};
  ranges[static_cast<std::size_t>(Varied::kFriction)] = {0.8, 1.2};
  ASSERT_TRUE(environment.SetRanges(ranges).ok());
  ASSERT_TRUE(environment.Reset(4).ok());
  ASSERT_TRUE(other.Reset(9).ok());
  math::Random random(3);
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(environment.Step(DrawAction(*model, random)).ok());
  std::vector<std::byte> bytes, once_more;
  environment.Save(bytes);
  ASSERT_TRUE(other.Restore(bytes).ok());
  other.Save(once_more);
  EXPECT_EQ(bytes, once_more);
  auto clone = environment.Clone();
  ASSERT_TRUE(clone.ok());
  for (int i = 0; i < 6; ++i) {
    const std::vector<double> action = DrawAction(*model, random);
    const auto a = environment.Step(action), b = other.Step(action), c = clone->Step(action);
    ASSERT_TRUE(a.ok() && b.ok() && c.ok());
    EXPECT_EQ(a->reward, b->reward);
    EXPECT_EQ(a->reward, c->reward);
  }
  // and the episodes after it
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(environment.Reset().ok() && other.Reset().ok() && clone->Reset().ok());
    EXPECT_EQ(environment.Drawn(), other.Drawn());
    EXPECT_EQ(environment.GetSimulation().Hash(), other.GetSimulation().Hash());
    EXPECT_EQ(environment.GetSimulation().Hash(), clone->GetSimulation().Hash());
  }
  // what is damaged changes nothing
  const std::uint64_t before = environment.GetSimulation().Hash();
  for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 50) {
    const auto refused = environment.Restore(std::span(bytes).first(length));
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, base::ErrorCode::kStateInvalid);
  }
  EXPECT_EQ(environment.GetSimulation().Hash(), before);
}

TEST(Environment, TipActionMovesTheTipByThatMuch) {
  Environment environment = MakeEnvironment({.task = "peg_transfer", .actions = ActionKind::kTip});
  ASSERT_TRUE(environment.Reset(1).ok());
  const math::Vec3 before =
      environment.GetSimulation().GetSnapshot().instruments[instrument::kLeft].X_world_tool.translation;
  std::vector<double> action(10);
  action[2] = 0.5;  // up, half of 0.12 m/s for 0.1 s
  ASSERT_TRUE(environment.Step(action).ok());
  const math::Vec3 moved =
      environment.GetSimulation().GetSnapshot().instruments[instrument::kLeft].X_world_tool.translation -
      before;
  EXPECT_NEAR(moved.z, 0.006, 5e-4);
  EXPECT_NEAR(moved.x, 0, 5e-4);
  EXPECT_NEAR(moved.y, 0, 5e-4);
}

TEST(Environment, RefusesWrongActions) {
  Environment environment = MakeEnvironment({.task = "peg_transfer"});
  const auto code = [&](std::vector<double> action) {
    const auto outcome = environment.Step(action);
    return outcome.ok() ? base::ErrorCode::kNone : outcome.error().code;
  };
  EXPECT_EQ(code(std::vector<double>(10)), base::ErrorCode::kEnvironmentState);  // before the reset
  ASSERT_TRUE(environment.Reset().ok());
  EXPECT_EQ(code(std::vector<double>(9)), base::ErrorCode::kActionInvalid);
  std::vector<double> action(10);
  action[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(action), base::ErrorCode::kActionInvalid);
  action[4] = 1.5;
  EXPECT_EQ(code(action), base::ErrorCode::kActionInvalid);
  action[4] = 1;
  EXPECT_EQ(code(action), base::ErrorCode::kNone);
  EXPECT_EQ(environment.ActionCount(), 1u);
}

// The number after 1 in single precision is what a policy gives that means 1.
TEST(Environment, CutsWhatLiesBeyondABoundByRounding) {
  for (const ActionKind kind : {ActionKind::kJoints, ActionKind::kTip}) {
    const auto model = MakeModel({.task = "camera_navigation_30", .actions = kind});
    Environment exact = std::move(*Environment::Make(model)), rounded = std::move(*Environment::Make(model));
    ASSERT_TRUE(exact.Reset(1).ok() && rounded.Reset(1).ok());
    std::vector<double> one(model->ActionSize()), more(one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      one[i] = i % 2 == 0 ? 1 : -1;
      more[i] =
          static_cast<double>(std::nextafter(static_cast<float>(one[i]), 2 * static_cast<float>(one[i])));
      ASSERT_GT(std::abs(more[i]), 1);
    }
    ASSERT_TRUE(exact.Step(one).ok());
    ASSERT_TRUE(rounded.Step(more).ok());
    EXPECT_EQ(exact.GetSimulation().Hash(), rounded.GetSimulation().Hash());
    one[2] = -1.00001;
    const auto refused = rounded.Step(one);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, base::ErrorCode::kActionInvalid);
    EXPECT_NE(refused.error().message.find(model->ActionFields()[2].name), std::string::npos);
    EXPECT_NE(refused.error().message.find("-1.00001;"), std::string::npos) << refused.error().message;
  }
}

// A surgeon's step changes no bit of what the surgeon does, and the action that it is said to amount to does the same.
TEST(Environment, IsPlayedByASurgeon) {
  // begins where the task's scene does
  const auto model = MakeModel({.task = "lift_and_grasp", .layouts = 1, .actions = ActionKind::kTip});
  Environment played = std::move(*Environment::Make(model)), repeated = std::move(*Environment::Make(model));
  ASSERT_TRUE(played.Reset(1).ok() && repeated.Reset(1).ok());
  const auto scene = std::make_shared<const scene::Scene>(played.GetSimulation().GetScene());
  auto simulation = simulation::Simulation::Make(scene);
  auto surgeon = agent::MakeSurgeon("expert", scene, 1), other = agent::MakeSurgeon("expert", scene, 1);
  ASSERT_TRUE(simulation.ok() && surgeon.ok() && other.ok());
  std::vector<double> action(model->ActionSize());
  Outcome outcome;
  for (int i = 0; !played.IsOver(); ++i) {
    const auto step =
        played.StepBy([&](const simulation::Snapshot& seen) { return (*surgeon)->Act(seen); }, action);
    ASSERT_TRUE(step.ok()) << step.error().Text();
    outcome = *step;
    ASSERT_TRUE(model->CheckAction(action).ok());
    for (int tick = 0; tick < model->TicksPerAction() && !simulation->GetSnapshot().task.IsOver(); ++tick)
      simulation->Step((*other)->Act(simulation->GetSnapshot()));
    ASSERT_EQ(played.GetSimulation().Hash(), simulation->Hash()) << "after action " << i;
    if (i >= 30) continue;
    ASSERT_TRUE(repeated.Step(action).ok());
    for (const int hand : {instrument::kLeft, instrument::kRight}) {
      const auto tip = [hand](const Environment& of) {
        return of.GetSimulation().GetSnapshot().instruments[hand].X_world_tool.translation;
      };
      ASSERT_LT(math::Distance(tip(played), tip(repeated)), 5e-4) << "after action " << i;
    }
  }
  EXPECT_TRUE(outcome.is_success);
}

TEST(Environment, IsPlayedByASurgeonOnlyWhileAnEpisodeRuns) {
  const auto rest = [](const simulation::Snapshot&) { return scene::Input{}; };
  std::vector<double> action(10);
  Environment environment = MakeEnvironment({.task = "peg_transfer"});
  EXPECT_EQ(environment.StepBy(rest, action).error().code, base::ErrorCode::kEnvironmentState);
  Environment discrete = MakeEnvironment({.task = "peg_transfer", .actions = ActionKind::kDiscrete});
  ASSERT_TRUE(discrete.Reset().ok());
  EXPECT_EQ(discrete.StepBy(rest, action).error().code, base::ErrorCode::kUsage);
}

TEST(Environment, RefusesWrongSettings) {
  const auto code = [](const EnvironmentSettings& settings) {
    const auto made = EnvironmentModel::Make(settings);
    return made.ok() ? base::ErrorCode::kNone : made.error().code;
  };
  EXPECT_EQ(code({.task = "juggling"}), base::ErrorCode::kUnknownName);
  EXPECT_EQ(code({.layouts = -1}), base::ErrorCode::kUsage);
  EXPECT_EQ(code({.models = 5000}), base::ErrorCode::kUsage);
  Ranges ranges = UsualRanges();
  ranges[static_cast<std::size_t>(Varied::kMass)] = {2, 1};
  EXPECT_EQ(code({.ranges = ranges}), base::ErrorCode::kUsage);
  EXPECT_EQ(code({.actions_per_second = std::nan("")}), base::ErrorCode::kUsage);
  EXPECT_EQ(code({.most_seconds = -1}), base::ErrorCode::kUsage);
}

TEST(Environment, EndsWhenItsTimeIsOver) {
  Environment environment = MakeEnvironment({.task = "peg_transfer", .most_seconds = 0.5});
  ASSERT_TRUE(environment.Reset().ok());
  const std::vector<double> still(10);
  for (int i = 0; i < 5; ++i) {
    const auto outcome = environment.Step(still);
    ASSERT_TRUE(outcome.ok());
    EXPECT_EQ(outcome->is_truncated, i == 4);
    EXPECT_FALSE(outcome->is_terminated);
  }
  EXPECT_EQ(environment.Step(still).error().code, base::ErrorCode::kEnvironmentState);
}

// An able surgeon's attempt gathers every goal and every step once, and comes nearer to what it wants.
TEST(RewardMeter, GathersEveryGoalOfTheExpert) {
  const auto path = files::FindTask("lift_and_grasp");
  ASSERT_TRUE(path.ok());
  auto read = files::ReadTask(*path, {.seed = 1});
  ASSERT_TRUE(read.ok());
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  auto surgeon = agent::MakeSurgeon("expert", scene, 1);
  ASSERT_TRUE(simulation.ok() && surgeon.ok());
  Features sum{};
  RewardMeter meter;
  while (!simulation->GetSnapshot().task.IsOver() && !(*surgeon)->HasFinished()) {
    meter.Begin(*simulation);
    for (int tick = 0; tick < 12; ++tick) {
      simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
      meter.AfterTick(*simulation);
    }
    const Features features = meter.End(*simulation);
    for (std::size_t i = 0; i < kFeatureCount; ++i) sum[i] += features[i];
  }
  const auto of = [&](Feature feature) { return sum[static_cast<std::size_t>(feature)]; };
  EXPECT_NEAR(of(Feature::kGoal), 1, 1e-9);
  EXPECT_NEAR(of(Feature::kStep), 1, 1e-9);
  EXPECT_EQ(of(Feature::kCompleted), 1);
  EXPECT_EQ(of(Feature::kError), 0);
  EXPECT_GT(of(Feature::kApproach), 0.02);
  EXPECT_GT(of(Feature::kForce), 0);
  EXPECT_GT(of(Feature::kPath), 0.05);
  EXPECT_NEAR(of(Feature::kTime), simulation->GetSnapshot().time, 1e-6);
}

TEST(Environment, EveryTaskStaysFiniteUnderRandomActions) {
  const auto tasks = files::ListTasks();
  ASSERT_TRUE(tasks.ok());
  for (const files::TaskEntry& task : *tasks) {
    SCOPED_TRACE(task.key);
    const auto model = MakeModel({.task = task.key, .actions = ActionKind::kTip});
    Environment environment = std::move(*Environment::Make(model));
    ASSERT_TRUE(environment.Reset(1).ok());
    std::vector<float> state(model->StateSize());
    math::Random random(7);
    for (int i = 0; i < 10 && !environment.IsOver(); ++i) {
      const auto outcome = environment.Step(DrawAction(*model, random));
      ASSERT_TRUE(outcome.ok()) << outcome.error().Text();
      ASSERT_TRUE(std::isfinite(outcome->reward));
      // where there is no patient nothing is gained of one
      for (const Feature feature : {Feature::kCleared, Feature::kDetached, Feature::kCriticalView})
        ASSERT_EQ(outcome->features[static_cast<std::size_t>(feature)], 0) << NameOf(feature);
      environment.Observe(state);
      for (const Field& field : model->StateFields()) {
        for (std::size_t k = 0; k < field.count; ++k)
          ASSERT_TRUE(std::isfinite(state[field.first + k])) << field.name;
      }
    }
  }
}

}  // namespace
}  // namespace trocar::environment
