// SPDX-License-Identifier: Apache-2.0
// People of known skill: levels differ as they say, each weakness shows where it should, and the same seed is the same person.
#include "trocar/agent/skill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "task_play.h"
#include "trocar/agent/hand_motion.h"

namespace trocar::agent {

using instrument::IsInView;
using math::Vec3;
using scene::TaskPhase;

namespace {

constexpr double kTick = 1.0 / 120;
constexpr double kMostSeconds = 170;

/// What a reach of 100 mm to the side came to.
struct Reach {
  double path = 0, farthest = 0, aside = 0, seconds = 0;
  Vec3 end;
};

Reach ReachAside(const HandSkill& skill) {
  const Vec3 port{0, 0, 0};
  const instrument::TrocarJoints start = instrument::FindJoints(port, {-0.05, 0, -0.12}, 0.0, 0.0);
  HandMotion hand(port, start, skill, 5);
  hand.MoveTo({0.05, 0, -0.12});
  Reach reach;
  Vec3 last = hand.Tip();
  while (hand.IsMoving()) {
    hand.Step(kTick);
    reach.path += math::Distance(hand.Tip(), last);
    last = hand.Tip();
    reach.farthest = std::max(reach.farthest, last.x);
    reach.aside = std::max(reach.aside, std::hypot(last.y, last.z + 0.12));
    reach.seconds += kTick;
  }
  reach.end = last;
  return reach;
}

TEST(HandMotion, OvershootsByItsShareAndComesBack) {
  HandSkill skill;
  skill.tremor = 0;
  const Reach plain = ReachAside(skill);
  skill.overshoot = 0.04;
  const Reach past = ReachAside(skill);
  EXPECT_NEAR(plain.farthest, 0.05, 1e-9);
  EXPECT_NEAR(past.farthest, 0.054, 1e-6);
  EXPECT_NEAR(past.end.x, 0.05, 1e-9);
  EXPECT_NEAR(past.path, plain.path + 0.008, 1e-5);
  EXPECT_GT(past.seconds, plain.seconds);
  skill.overshoot = 0.5;
  EXPECT_NEAR(ReachAside(skill).farthest, 0.056, 1e-6) << "6 mm at most";
}

TEST(HandMotion, WandersAsideNeverDownAndArrives) {
  HandSkill skill;
  skill.tremor = 0;
  skill.wander = 0.3;
  const Reach reach = ReachAside(skill);
  EXPECT_NEAR(reach.aside, 0.03, 1e-3);
  EXPECT_GT(reach.path, 0.110);
  EXPECT_NEAR(math::Distance(reach.end, {0.05, 0, -0.12}), 0, 1e-9);
  const Vec3 port{0, 0, 0};
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    HandMotion hand(port, instrument::FindJoints(port, {-0.05, 0, -0.12}, 0.0, 0.0), skill, seed);
    hand.MoveTo({0.05, 0, -0.12});
    while (hand.IsMoving()) {
      hand.Step(kTick);
      ASSERT_GE(hand.Tip().z, -0.12 - 1e-12) << "seed " << seed;
    }
  }
}

/// Saved in the middle of a reach that goes astray and past its end.
TEST(HandMotion, GoesOnAfterRestoring) {
  HandSkill skill;
  skill.wander = 0.2, skill.overshoot = 0.05;
  const Vec3 port{0, 0, 0};
  const auto start = instrument::FindJoints(port, {-0.05, 0, -0.12}, 0.0, 0.0);
  for (const int ticks : {10, 60, 120, 190}) {
    HandMotion hand(port, start, skill, 5), other(port, start, skill, 5);
    hand.MoveTo({0.05, 0, -0.12});
    for (int i = 0; i < ticks; ++i) hand.Step(kTick);
    std::vector<std::byte> bytes;
    base::StateArchive save = base::StateArchive::ForSave(bytes);
    hand.VisitState(save);
    base::StateArchive restore = base::StateArchive::ForRestore(bytes);
    other.VisitState(restore);
    ASSERT_TRUE(restore.ok());
    for (int i = 0; i < 400; ++i) ASSERT_EQ(hand.Step(kTick), other.Step(kTick)) << ticks << " + " << i;
  }
}

TEST(Skill, SamplesStayNearAndRepeat) {
  const SurgeonSkill novice = LevelSkill(SkillLevel::kNovice);
  double least = 1e9, most = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const SurgeonSkill one = SampleSkill(novice, 0.2, seed);
    least = std::min(least, one.hand.speed / novice.hand.speed);
    most = std::max(most, one.hand.speed / novice.hand.speed);
    EXPECT_EQ(one.hand.tremor, SampleSkill(novice, 0.2, seed).hand.tremor);
    EXPECT_LE(one.delay, 0.5);
  }
  EXPECT_GE(least, 1 / 1.2 - 1e-12);
  EXPECT_LE(most, 1.2 + 1e-12);
  EXPECT_LT(least, 0.86);
  EXPECT_GT(most, 1.16);
  const SurgeonSkill same = SampleSkill(novice, 0, 7);
  EXPECT_EQ(same.hand.speed, novice.hand.speed);
}

/// What a play showed of hands, camera and feet.
struct Shown {
  TaskPhase phase = TaskPhase::kNone;
  double seconds = 0, path = 0, force = 0;
  int unseen = 0, both = 0, errors = 0;
  std::uint64_t hash = 0;
};

Shown Play(const std::string& task, const SurgeonSkill& skill, std::uint64_t seed) {
  const auto scene = ReadDelivered(task, {"normal", seed, {}});
  auto surgeon = MakeSkilledSurgeon(scene, skill, seed);
  EXPECT_TRUE(surgeon.ok());
  auto simulation = simulation::Simulation::Make(scene);
  EXPECT_TRUE(simulation.ok());
  Shown shown;
  std::array<Vec3, instrument::kHandCount> last;
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < kMostSeconds) {
    simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
    const simulation::Snapshot& now = simulation->GetSnapshot();
    int moving = 0;
    for (std::size_t h = 0; h < last.size(); ++h) {
      const Vec3& tip = now.instruments[h].X_world_tool.translation;
      const double step = now.tick > 1 ? math::Distance(tip, last[h]) : 0;
      last[h] = tip;
      shown.path += step;
      shown.force = std::max(shown.force, math::Norm(now.instruments[h].force));
      moving += step > 0.02 * scene->tick_seconds ? 1 : 0;
      shown.unseen += IsInView(now.X_world_laparoscope, scene->laparoscope.field_of_view, tip) ? 0 : 1;
    }
    shown.both += moving == 2 ? 1 : 0;
  }
  const simulation::Snapshot& end = simulation->GetSnapshot();
  shown.phase = end.task.phase;
  shown.seconds = end.task.time;
  shown.errors = static_cast<int>(end.task.error_count);
  shown.hash = simulation->Hash();
  return shown;
}

class SkilledTask : public testing::TestWithParam<const char*> {};

TEST_P(SkilledTask, IsDoneByTheExpertWithoutAnErrorAndByTheOthersMoreSlowly) {
  const Shown expert = Play(GetParam(), LevelSkill(SkillLevel::kExpert), 3),
              middle = Play(GetParam(), LevelSkill(SkillLevel::kIntermediate), 3),
              novice = Play(GetParam(), LevelSkill(SkillLevel::kNovice), 3);
  EXPECT_EQ(expert.phase, TaskPhase::kCompleted);
  EXPECT_EQ(expert.errors, 0);
  EXPECT_EQ(middle.phase, TaskPhase::kCompleted);
  EXPECT_EQ(novice.phase, TaskPhase::kCompleted);
  EXPECT_LT(expert.seconds, middle.seconds);
  EXPECT_LT(middle.seconds, novice.seconds);
}

INSTANTIATE_TEST_SUITE_P(Tasks, SkilledTask,
                         testing::Values("instrument_navigation", "object_transport", "hook_dissection"),
                         [](const auto& task) { return std::string(task.param); });

TEST(Skill, TheSameSeedIsTheSamePerson) {
  const SurgeonSkill novice = SampleSkill(LevelSkill(SkillLevel::kNovice), 0.2, 4);
  const Shown once = Play("instrument_navigation", novice, 4);
  EXPECT_EQ(Play("instrument_navigation", novice, 4).hash, once.hash);
  EXPECT_NE(Play("instrument_navigation", SampleSkill(LevelSkill(SkillLevel::kNovice), 0.2, 5), 4).hash,
            once.hash);
}

// Each weakness against the same person without it.
TEST(Weaknesses, ShowInWhatTheyName) {
  const SurgeonSkill able = LevelSkill(SkillLevel::kExpert);
  const auto weak = [&](const char* task, Weakness weakness) {
    return Play(task, PlantWeakness(able, weakness), 3);
  };
  const Shown transport = Play("object_transport", able, 3), hook = Play("hook_dissection", able, 3),
              navigation = Play("instrument_navigation", able, 3);
  EXPECT_LT(2 * weak("object_transport", Weakness::kIdleHand).both, transport.both);
  EXPECT_GT(weak("object_transport", Weakness::kForce).force, 1.5 * transport.force);
  EXPECT_GT(weak("instrument_navigation", Weakness::kPoorCamera).unseen, navigation.unseen + 120);
  EXPECT_GT(weak("instrument_navigation", Weakness::kWandering).path, 1.1 * navigation.path);
  EXPECT_GT(weak("instrument_navigation", Weakness::kTremor).path, 1.3 * navigation.path);
  EXPECT_GT(weak("instrument_navigation", Weakness::kOvershoot).path, 1.02 * navigation.path);
  EXPECT_GT(weak("instrument_navigation", Weakness::kHesitation).seconds, navigation.seconds + 4);
  EXPECT_GT(weak("instrument_navigation", Weakness::kDelay).seconds, navigation.seconds);
  EXPECT_GT(weak("instrument_navigation", Weakness::kWrongPlan).path, 1.1 * navigation.path);
  EXPECT_GT(weak("hook_dissection", Weakness::kEnergyInAir).errors, hook.errors);
}

TEST(Weaknesses, AreListedWhereTheyCanShow) {
  const auto hook = ReadDelivered("hook_dissection"), pegs = ReadDelivered("peg_transfer");
  EXPECT_TRUE(CanShow(Weakness::kEnergyInAir, *hook));
  EXPECT_FALSE(CanShow(Weakness::kEnergyInAir, *pegs));
  EXPECT_TRUE(CanShow(Weakness::kIdleHand, *pegs));
  EXPECT_FALSE(CanShow(Weakness::kIdleHand, *hook));
  EXPECT_TRUE(MakeSurgeon("one_handed", pegs, 1).ok());
  EXPECT_FALSE(MakeSurgeon("burns_early", pegs, 1).ok());
}

/// Inputs that wait and a picture that drifts are memory, too.
TEST(SkilledSurgeon, GoesOnAfterRestoring) {
  const auto scene = ReadDelivered("object_transport");
  auto simulation = simulation::Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  const auto make = [&] { return std::move(*MakeSkilledSurgeon(scene, LevelSkill(SkillLevel::kNovice), 3)); };
  const std::unique_ptr<Surgeon> surgeon = make();
  std::unique_ptr<Surgeon> follower;
  for (int tick = 0; tick < 2400; ++tick) {
    if (tick == 700) {
      std::vector<std::byte> bytes;
      base::StateArchive save = base::StateArchive::ForSave(bytes);
      surgeon->VisitState(save);
      follower = make();
      base::StateArchive restore = base::StateArchive::ForRestore(bytes);
      follower->VisitState(restore);
      ASSERT_TRUE(restore.ok()) << restore.Failure();
    }
    const scene::Input input = surgeon->Act(simulation->GetSnapshot());
    if (follower != nullptr) {
      ASSERT_EQ(follower->Act(simulation->GetSnapshot()), input) << tick;
    }
    simulation->Step(input);
  }
}

}  // namespace
}  // namespace trocar::agent
