// SPDX-License-Identifier: Apache-2.0
// Every word of the vocabulary, on snapshots made by hand.
#include "task_monitor.h"

#include <gtest/gtest.h>

namespace trocar::simulation {

using instrument::kLeft;
using instrument::kRight;
using scene::Condition;
using scene::ConditionKind;
using scene::RegionMark;
using scene::Task;
using scene::TaskPhase;
using surgery::FactKind;

namespace {

constexpr double kTick = 1.0 / 120;
constexpr double kDegree = M_PI / 180;

/// Two things, two regions, and a task of one goal and one error.
class Vocabulary : public testing::Test {
 protected:
  Vocabulary() {
    scene_.tick_seconds = kTick;
    scene_.objects.resize(2);
    scene_.objects[0].name = "ring";
    scene_.objects[0].body.X_world_body.translation = {0, 0, -0.140};
    scene_.objects[1].name = "wire";
    Task task;
    task.regions = {{"ball", {0, 0, -0.1}, 0.01, {}, {}, RegionMark::kNone},
                    {"box", {0.05, 0, -0.1}, 0, {0.01, 0.02, 0.03}, {}, RegionMark::kNone}};
    task.goals.resize(1);
    task.errors.resize(1);
    task.errors[0].penalty = 7;
    task.time_limit = 10;
    scene_.task = task;
    snapshot_.objects.resize(2);
    snapshot_.objects[0].X_world_object.translation = {0, 0, -0.140};
    snapshot_.X_world_laparoscope = {{}, {0, 0, 0}};  // looks down
  }

  /// The condition becomes the goal's only step and the error's.
  void Start(Condition condition) {
    scene_.task->goals[0].steps = {condition};
    scene_.task->errors[0].when = {condition};
    monitor_.Reset(scene_, snapshot_.task);
    snapshot_.instruments[0].X_world_device.translation = {1, 0, 0};  // far from home: the clock runs
  }
  void Tick(int count = 1) {
    for (int i = 0; i < count; ++i) {
      ++snapshot_.tick;
      monitor_.Update(scene_, snapshot_, snapshot_.task);
    }
  }
  bool IsDone() const { return snapshot_.task.goals[0].is_done; }
  scene::ObjectSnapshot& Ring() { return snapshot_.objects[0]; }

  scene::Scene scene_;
  Snapshot snapshot_;
  TaskMonitor monitor_;
};

Condition Of(ConditionKind kind) {
  Condition condition;
  condition.kind = kind;
  return condition;
}
Condition OfRing(ConditionKind kind) {
  Condition condition = Of(kind);
  condition.object = 0;
  return condition;
}

TEST_F(Vocabulary, HeldMeansTheNamedHand) {
  Condition held = OfRing(ConditionKind::kHeld);
  held.hand = kRight;
  Start(held);
  Tick();
  EXPECT_FALSE(IsDone());
  Ring().held_by = 1;
  Tick();
  EXPECT_FALSE(IsDone()) << "the left hand is not the right one";
  Ring().held_by = 2;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, LiftedMeansHeldAndHighEnough) {
  Condition lifted = OfRing(ConditionKind::kLifted);
  lifted.amount = 0.010;
  Start(lifted);
  Ring().X_world_object.translation.z = -0.125;
  Tick();
  EXPECT_FALSE(IsDone()) << "nobody holds it";
  Ring().held_by = 1;
  Ring().X_world_object.translation.z = -0.131;
  Tick();
  EXPECT_FALSE(IsDone());
  Ring().X_world_object.translation.z = -0.129;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, HandedOverMeansBothHandsInTheAirLongEnough) {
  Condition over = OfRing(ConditionKind::kHandedOver);
  over.hand = kLeft, over.to = kRight, over.seconds = 0.1;
  const auto pass = [&](int ticks_both, std::uint64_t touches, std::uint8_t first, std::uint8_t last) {
    Start(over);
    Ring().touches = touches;
    Ring().held_by = first;
    Tick();
    Ring().held_by = 3;
    Tick(ticks_both);
    Ring().held_by = last;
    Tick();
    return IsDone();
  };
  EXPECT_TRUE(pass(13, 0, 1, 2));
  EXPECT_FALSE(pass(11, 0, 1, 2)) << "less than 100 ms";
  EXPECT_FALSE(pass(13, 2, 1, 2)) << "it lay on something";
  EXPECT_FALSE(pass(13, 0, 2, 1)) << "the other way";
  EXPECT_FALSE(pass(13, 0, 1, 0)) << "both let go";
}

TEST_F(Vocabulary, RegionsAreBallsAndBoxes) {
  Condition in = OfRing(ConditionKind::kInRegion);
  in.regions = {0, 1};
  Start(in);
  Ring().X_world_object.translation = {0, 0.0101, -0.1};
  Tick();
  EXPECT_FALSE(IsDone());
  Ring().X_world_object.translation = {0.05, 0.019, -0.129};
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, PlacedMeansLetGoAndAtRest) {
  Condition placed = OfRing(ConditionKind::kPlaced);
  placed.regions = {0};
  Start(placed);
  Ring().X_world_object.translation = {0, 0, -0.1};
  Ring().held_by = 1;
  Tick();
  EXPECT_FALSE(IsDone());
  Ring().held_by = 0;
  Ring().is_at_rest = false;
  Tick();
  EXPECT_FALSE(IsDone());
  Ring().is_at_rest = true;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, SecondsMustHoldWithoutABreak) {
  Condition tip = Of(ConditionKind::kTipInRegion);
  tip.hand = kRight, tip.regions = {0}, tip.seconds = 0.5;
  Start(tip);
  math::Vec3& at = snapshot_.instruments[kRight].X_world_tool.translation;
  at = {0, 0, -0.1};
  Tick(59);
  at = {0, 0.02, -0.1};
  Tick();
  at = {0, 0, -0.1};
  Tick(59);
  EXPECT_FALSE(IsDone());
  Tick(2);
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, CameraSeesWithinAngleDistanceAndFromTheRightSide) {
  Condition sees = Of(ConditionKind::kCameraSees);
  sees.regions = {0}, sees.angle = 5 * kDegree, sees.near = 0.05, sees.far = 0.12,
  sees.facing_angle = 40 * kDegree;
  scene_.task->regions[0].facing = math::Vec3{0, 0, 1};
  const auto seen_from = [&](const math::Pose& X) {
    Start(sees);
    snapshot_.X_world_laparoscope = X;
    Tick();
    return IsDone();
  };
  EXPECT_TRUE(seen_from({{}, {0, 0, 0}}));
  EXPECT_FALSE(seen_from({{}, {0, 0, -0.06}})) << "too near";
  EXPECT_FALSE(seen_from({{}, {0, 0, 0.03}})) << "too far";
  EXPECT_FALSE(seen_from({{}, {0.01, 0, 0}})) << "5.7 degrees off";
  EXPECT_TRUE(seen_from({{}, {0.008, 0, 0}}));
  EXPECT_FALSE(seen_from({math::RotationAbout({1, 0, 0}, M_PI), {0, 0, -0.2}})) << "from behind";
}

TEST_F(Vocabulary, ErrorsCountEachTimeTheyBegin) {
  Condition touches = OfRing(ConditionKind::kTouches);
  touches.other = 1, touches.while_held = true;
  Start(touches);
  scene_.task->goals[0].steps = {Of(ConditionKind::kForceAbove)};
  scene_.task->goals[0].steps[0].amount = 100;
  Ring().touches = 2;
  Tick(5);
  EXPECT_EQ(snapshot_.task.errors[0], 0u) << "nobody holds it";
  Ring().held_by = 2;
  Tick(5);
  EXPECT_EQ(snapshot_.task.errors[0], 1u);
  Ring().touches = 0;
  Tick();
  Ring().touches = 2;
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 2u);
  EXPECT_EQ(snapshot_.task.penalty, 14);
  EXPECT_EQ(snapshot_.task.error_count, 2u);
  EXPECT_EQ(snapshot_.task.last_errors[1].hand, kRight);
  EXPECT_EQ(snapshot_.task.last_errors[1].object, 0);
  EXPECT_NEAR(snapshot_.task.last_errors[1].position.z, -0.140, 1e-12);
}

TEST_F(Vocabulary, DroppedMeansLetGoInTheAirAndFallen) {
  Condition dropped = OfRing(ConditionKind::kDropped);
  dropped.amount = 0.01;
  const auto let_go = [&](std::uint64_t touches, double fall) {
    Start(dropped);
    Ring().held_by = 1, Ring().touches = 0, Ring().is_at_rest = false;
    Ring().X_world_object.translation.z = -0.1;
    Tick();
    Ring().held_by = 0, Ring().touches = touches;
    Tick();
    Ring().X_world_object.translation.z -= fall;
    Tick();
    return snapshot_.task.errors[0] == 1;
  };
  EXPECT_TRUE(let_go(0, 0.012));
  EXPECT_FALSE(let_go(0, 0.008));
  EXPECT_FALSE(let_go(2, 0.012)) << "let go on something";
}

TEST_F(Vocabulary, OutsideAndOutOfView) {
  Condition outside = OfRing(ConditionKind::kOutside);
  outside.regions = {1};
  Start(outside);
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u);
  scene_.laparoscope.field_of_view = 60 * kDegree;
  Condition unseen = OfRing(ConditionKind::kOutOfView);
  Start(unseen);
  Ring().X_world_object.translation = {0.05, 0, -0.1};  // 26.6 degrees
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 0u);
  Ring().X_world_object.translation = {0.06, 0, -0.1};  // 31
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u);
}

TEST_F(Vocabulary, ToolsForceViewAndEvents) {
  Condition press = OfRing(ConditionKind::kToolTouches);
  press.object = 1, press.amount = 2;
  Start(press);
  snapshot_.objects[1].touched_by = 1;
  snapshot_.instruments[kRight].force = {9, 0, 0};
  Tick();
  EXPECT_FALSE(IsDone()) << "the hand that presses does not touch it";
  snapshot_.instruments[kLeft].force = {0, 0, 2.1};
  Tick();
  EXPECT_TRUE(IsDone());

  Condition force = Of(ConditionKind::kForceAbove);
  force.hand = kLeft, force.amount = 3;
  Start(force);
  Tick();
  EXPECT_FALSE(IsDone());
  snapshot_.instruments[kLeft].force = {0, 0, 3.1};
  Tick();
  EXPECT_TRUE(IsDone());

  Condition unseen = Of(ConditionKind::kTipOutOfView);
  unseen.hand = kRight;
  Start(unseen);
  snapshot_.instruments[kRight].X_world_tool.translation = {0, 0, -0.1};
  Tick();
  EXPECT_FALSE(IsDone());
  snapshot_.instruments[kRight].X_world_tool.translation = {0.2, 0, -0.1};
  Tick();
  EXPECT_TRUE(IsDone());

  Condition slip = Of(ConditionKind::kEvent);
  slip.event = static_cast<int>(FactKind::kSlip), slip.hand = kRight;
  Start(slip);
  snapshot_.events[0] = {FactKind::kSlip, 1, kLeft, -1, 0, 0};
  snapshot_.event_count = 1;
  Tick();
  EXPECT_FALSE(IsDone()) << "the other hand's";
  snapshot_.events[1] = {FactKind::kSlip, 1, kRight, -1, 0, 0};
  snapshot_.event_count = 2;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(Vocabulary, TimeRunsFromTheFirstMovementToTheLimit) {
  Start(OfRing(ConditionKind::kHeld));
  snapshot_.instruments[0].X_world_device.translation =
      instrument::CalcToolPose(scene_.instruments[0].p_world_port, scene_.instruments[0].home).translation;
  snapshot_.instruments[1].X_world_device = snapshot_.instruments[0].X_world_device;
  snapshot_.X_world_laparoscope =
      instrument::CalcToolPose(scene_.laparoscope.p_world_port, scene_.laparoscope.home);
  Tick(50);
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kReady);
  EXPECT_EQ(snapshot_.task.time, 0);
  snapshot_.instruments[0].X_world_device.translation.x += 0.003;
  Tick(1199);
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kRunning);
  Tick(2);
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kTimeOver);
  Ring().held_by = 1;
  Tick();
  EXPECT_FALSE(IsDone()) << "after the end nothing counts";
}

TEST_F(Vocabulary, ScoreIsTimeSavedLessPenaltiesInPercentOfTheReference) {
  Task& task = *scene_.task;
  task.points_per_second_left = 2;
  task.reference_points = 40;
  task.goals[0].points = 10;
  Condition held = OfRing(ConditionKind::kHeld);
  Start(held);
  task.errors[0].when = {Of(ConditionKind::kForceAbove)};
  task.errors[0].when[0].amount = 1;
  snapshot_.instruments[0].force = {5, 0, 0};
  Tick(120);
  EXPECT_EQ(snapshot_.task.score, 0) << "no goal yet, and an error: never below nothing";
  Ring().held_by = 1;
  Tick();
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kCompleted);
  // 10 points, 2 for each of 10 s less 121 ticks, 7 off; of 40
  EXPECT_NEAR(snapshot_.task.score, 100.0 / 40 * (10 + 2 * (10 - 121 * kTick) - 7), 1e-9);
}

TEST_F(Vocabulary, StagesWaitForThoseBefore) {
  Task& task = *scene_.task;
  task.goals.resize(2);
  Start(OfRing(ConditionKind::kHeld));
  task.goals[1].steps = {OfRing(ConditionKind::kTouches)};
  task.goals[1].steps[0].other = 1;
  task.goals[1].stage = 1;
  task.errors[0].when.clear();
  monitor_.Reset(scene_, snapshot_.task);
  Ring().touches = 2;
  Tick(3);
  EXPECT_FALSE(snapshot_.task.goals[1].is_done);
  Ring().held_by = 1;
  Tick(2);
  EXPECT_TRUE(snapshot_.task.goals[1].is_done);
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kCompleted);
}

TEST_F(Vocabulary, AnErrorMayEndTheTask) {
  scene_.task->errors[0].ends_task = true;
  Start(OfRing(ConditionKind::kHeld));
  scene_.task->goals[0].steps = {OfRing(ConditionKind::kTouches)};
  scene_.task->goals[0].steps[0].other = 1;
  Ring().held_by = 1;
  Tick();
  EXPECT_EQ(snapshot_.task.phase, TaskPhase::kEnded);
}

}  // namespace
}  // namespace trocar::simulation
