// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/grasp.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "organ_fixture.h"

namespace trocar::surgery {
namespace {

class Grasping : public OrganFixture {
 protected:
  static constexpr double kOpen = 0.8, kClosed = 0.05;

  GraspChange Move(const Vec3& tip, double jaw) {
    return UpdateGrasp(tool_, {{}, tip}, jaw, organs_, model_, settings_, grasp_, state_);
  }
  /// Opens over the organ's top and closes on it.
  GraspChange Take(const Vec3& tip = {0, 0, 0.018}) {
    EXPECT_EQ(Move(tip, kOpen), GraspChange::kNone);
    return Move(tip, kClosed);
  }

  GraspSettings settings_;
  Grasp grasp_;
};

TEST_F(Grasping, TakesWhatLiesBetweenTheJawsAndCarriesIt) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  EXPECT_EQ(grasp_.organ, 0);
  ASSERT_GT(grasp_.count, 0u);
  const Vec3 before = state_.position[grasp_.nodes[0]];
  EXPECT_EQ(Move({0.01, 0.002, 0.023}, kClosed), GraspChange::kNone);
  EXPECT_NEAR(math::Distance(state_.position[grasp_.nodes[0]], before + Vec3{0.01, 0.002, 0.005}), 0.0,
              1e-12);
  (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 2000, 1e-6, 0.0}, {}, state_);
  const Vec3 force = solver_->CalcReaction({}, state_, grasp_.Nodes());
  EXPECT_LT(force.x, -0.05) << "the organ pulls back";
}

TEST_F(Grasping, ClosingOnNothingIsAMiss) {
  EXPECT_EQ(Take({0, 0, 0.05}), GraspChange::kMissed);
  EXPECT_FALSE(grasp_.IsHolding());
}

TEST_F(Grasping, NeedsOpeningBeforeEachGraspAndHasHysteresis) {
  EXPECT_EQ(Move({0, 0, 0.018}, kClosed), GraspChange::kNone)
      << "closed from the start: nothing between the jaws";
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  EXPECT_EQ(Move({0, 0, 0.018}, 0.30 * tool_.max_jaw), GraspChange::kNone)
      << "between the thresholds it holds";
  EXPECT_TRUE(grasp_.IsHolding());
  EXPECT_EQ(Move({0, 0, 0.018}, 0.40 * tool_.max_jaw), GraspChange::kReleased);
  for (const auto condition : state_.condition) EXPECT_EQ(condition, tissue::NodeCondition::kFree);
}

TEST_F(Grasping, SlipsOnlyWhenThePullLasts) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  const double too_much = settings_.HoldLimit() + 0.1;
  for (int tick = 1; tick < settings_.slip_ticks; ++tick) {
    EXPECT_EQ(UpdateSlip(too_much, settings_, model_, grasp_, state_), GraspChange::kNone);
  }
  EXPECT_EQ(UpdateSlip(0.1, settings_, model_, grasp_, state_), GraspChange::kNone)
      << "a moment of ease starts anew";
  for (int tick = 1; tick < settings_.slip_ticks; ++tick) {
    EXPECT_EQ(UpdateSlip(too_much, settings_, model_, grasp_, state_), GraspChange::kNone);
  }
  EXPECT_EQ(UpdateSlip(too_much, settings_, model_, grasp_, state_), GraspChange::kSlipped);
  EXPECT_FALSE(grasp_.IsHolding());
}

TEST_F(Grasping, LeavesNodesThatAnotherToolHolds) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  Grasp other;
  EXPECT_EQ(UpdateGrasp(tool_, {{}, {0, 0, 0.018}}, kOpen, organs_, model_, settings_, other, state_),
            GraspChange::kNone);
  (void)UpdateGrasp(tool_, {{}, {0, 0, 0.018}}, kClosed, organs_, model_, settings_, other, state_);
  for (const auto node : other.Nodes()) {
    EXPECT_EQ(std::count(grasp_.nodes.begin(), grasp_.nodes.begin() + static_cast<long>(grasp_.count), node),
              0);
  }
}

TEST_F(Grasping, LeavesNodesThatAnatomyHolds) {
  for (std::size_t i = 0; i < model_.Size(); ++i) state_.condition[i] = tissue::NodeCondition::kPrescribed;
  EXPECT_EQ(Take(), GraspChange::kMissed);
}

}  // namespace
}  // namespace trocar::surgery
