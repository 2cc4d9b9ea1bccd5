// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/grasp.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "organ_fixture.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

class Grasping : public OrganFixture {
 protected:
  static constexpr double kOpen = 0.8, kClosed = 0.05;

  GraspChange Move(const Vec3& tip, double jaw) {
    return UpdateGrasp(tool_, {{}, tip}, {{}, tip}, jaw, organs_, &tubes_, model_, grip_, grasp_, state_);
  }
  /// Opens over the organ's top and closes on it.
  GraspChange Take(const Vec3& tip = {0, 0, 0.018}) {
    EXPECT_EQ(Move(tip, kOpen), GraspChange::kNone);
    return Move(tip, kClosed);
  }

  GraspSettings grip_;
  Grasp grasp_;
};

TEST_F(Grasping, TakesWhatLiesBetweenTheJawsAndCarriesIt) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  EXPECT_EQ(grasp_.surface, 0);
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
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    EXPECT_EQ(state_.condition[i] == tissue::NodeCondition::kFree, model_.is_fixed[i] == 0);
  }
}

TEST_F(Grasping, SlipsOnlyWhenThePullLasts) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  const double too_much = grip_.friction * grasp_.pinch + 0.1;
  for (int tick = 1; tick < grip_.slip_ticks; ++tick) {
    EXPECT_EQ(UpdateSlip(too_much, grip_, model_, grasp_, state_), GraspChange::kNone);
  }
  EXPECT_EQ(UpdateSlip(0.1, grip_, model_, grasp_, state_), GraspChange::kNone)
      << "a moment of ease starts anew";
  for (int tick = 1; tick < grip_.slip_ticks; ++tick) {
    EXPECT_EQ(UpdateSlip(too_much, grip_, model_, grasp_, state_), GraspChange::kNone);
  }
  EXPECT_EQ(UpdateSlip(too_much, grip_, model_, grasp_, state_), GraspChange::kSlipped);
  EXPECT_FALSE(grasp_.IsHolding());
}

TEST_F(Grasping, LeavesNodesThatAnotherToolHolds) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  Grasp other;
  const math::Pose X_world_tool{{}, {0, 0, 0.018}};
  for (const double jaw : {kOpen, kClosed}) {
    (void)UpdateGrasp(tool_, X_world_tool, X_world_tool, jaw, organs_, &tubes_, model_, grip_, other, state_);
  }
  for (const auto node : other.Nodes()) {
    EXPECT_EQ(std::count(grasp_.nodes.begin(), grasp_.nodes.begin() + static_cast<long>(grasp_.count), node),
              0);
  }
}

TEST_F(Grasping, LeavesNodesThatAnatomyHolds) {
  for (std::size_t i = 0; i < model_.Size(); ++i) state_.condition[i] = tissue::NodeCondition::kPrescribed;
  EXPECT_EQ(Take(), GraspChange::kMissed);
}

TEST_F(Grasping, TakesADuct) {
  const Vec3 at{0.002, 0.06, -0.006};
  ASSERT_EQ(Take(at), GraspChange::kGrasped);
  EXPECT_EQ(grasp_.surface, 1) << "organs first, then tubes";
  ASSERT_GT(grasp_.count, 0u);
  const Vec3 before = DuctMiddle();
  (void)Move(at + Vec3{0, 0, 0.01}, kClosed);
  (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 2000, 1e-6, 0.0}, {}, state_);
  EXPECT_GT(DuctMiddle().z, before.z + 0.005);
}

// Domain facts, section 3.3: against a pull of 5 N, a pinch of 3.0 N is just enough.
TEST_F(Grasping, AHarderPinchHoldsAHarderPull) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  const Vec3 tip{0, 0, 0.018};
  grasp_.jaw_at_closing = 0.2;
  (void)Move(tip, 0.2);
  EXPECT_NEAR(grasp_.pinch, 3.0, 1e-12);
  const auto slips_at = [&](double pull) {
    Grasp held = grasp_;
    tissue::TissueState state = state_;
    GraspChange change = GraspChange::kNone;
    for (int tick = 0; tick < grip_.slip_ticks; ++tick) change = UpdateSlip(pull, grip_, model_, held, state);
    return change == GraspChange::kSlipped;
  };
  EXPECT_FALSE(slips_at(5.0));
  EXPECT_TRUE(slips_at(5.2));
  (void)Move(tip, 0.1);
  EXPECT_FALSE(slips_at(5.2)) << "squeezed harder";
  (void)Move(tip, 0.0);
  EXPECT_NEAR(grasp_.pinch, grip_.most_pinch, 1e-12);
}

TEST_F(Grasping, TooHardAPinchDamagesASmallBiteOnceAndALargeOneNever) {
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  EXPECT_GT(grasp_.damage_pinch, 15.0);
  EXPECT_LE(grasp_.damage_pinch, 37.0);
  grasp_.jaw_at_closing = 0.2;
  grasp_.damage_pinch = 25.0;
  EXPECT_EQ(Move({0, 0, 0.018}, 0.0), GraspChange::kNone) << "most_pinch is 20 N";
  grasp_.damage_pinch = 16.0;
  EXPECT_EQ(Move({0, 0, 0.018}, 0.19), GraspChange::kNone) << "held gently";
  EXPECT_EQ(Move({0, 0, 0.018}, 0.0), GraspChange::kDamaged);
  EXPECT_EQ(Move({0, 0, 0.018}, 0.0), GraspChange::kNone) << "said once";
}

// The liver bears 2 N.
TEST_F(Grasping, AnOrganThatBearsLittleIsDamagedByClosing) {
  organs_[0].damage_pinch_small = organs_[0].damage_pinch_full = 2.0;
  ASSERT_EQ(Take(), GraspChange::kGrasped);
  EXPECT_EQ(Move({0, 0, 0.018}, kClosed), GraspChange::kDamaged);
}

}  // namespace
}  // namespace trocar::surgery
