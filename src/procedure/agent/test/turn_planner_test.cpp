// SPDX-License-Identifier: Apache-2.0
// Turning a made-up organ about the tube that holds it.
#include "turn_planner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/pose.h"

namespace trocar::agent {

using math::Vec3;

namespace {

/// A tube of 30 mm along x; the organ is at its end, and is held 20 mm above.
const TurnAxis kTube{{0.030, 0, 0}, {0, 0, 0}};
const HoldPose kHold{{0.030, 0, 0.15}, {0.030, 0, 0.020}};
const Vec3 kFallback{0, 1, 0};

TEST(TurnAside, DrawsTheHoldRoundTheTubeToTheSideAskedFor) {
  const HoldTurn one = TurnAside(kHold, kTube, 1, 0.014, 0, kFallback),
                 other = TurnAside(kHold, kTube, -1, 0.014, 0, kFallback);
  EXPECT_NEAR(math::Norm(one.by), 0.014, 1e-12);
  EXPECT_NEAR(math::Dot(one.by, {1, 0, 0}), 0.0, 1e-12) << "about the tube, not along it";
  EXPECT_NEAR(math::Dot(one.by, {0, 0, 1}), 0.0, 1e-12) << "no farther from it";
  EXPECT_LT(math::Distance(one.by, -1.0 * other.by), 1e-12);
  EXPECT_EQ(one.roll, 0.0);
}

TEST(TurnAside, RollsAsMuchAsTheTubeLiesAlongTheShaft) {
  EXPECT_NEAR(TurnAside(kHold, kTube, 1, 0.014, 0.3, kFallback).roll, 0.0, 1e-12) << "across the shaft";
  const TurnAxis upright{{0, 0, 0.010}, {0, 0, -0.020}};
  const HoldPose beside{{0.020, 0, 0.15}, {0.020, 0, 0.010}};
  EXPECT_NEAR(std::fabs(TurnAside(beside, upright, 1, 0.014, 0.3, kFallback).roll), 0.3, 1e-12);
}

TEST(TurnAside, HasAWayOutWhereTheHandHoldsOnTheAxis) {
  const HoldPose on_axis{{0.05, 0, 0.15}, {0.045, 0, 0}};
  EXPECT_NEAR(math::Norm(TurnAside(on_axis, kTube, 1, 0.014, 0, kFallback).by), 0.014, 1e-9);
}

TEST(TakeRound, KeepsTheHoldsDistanceFromTheTube) {
  const Vec3 at_rest = kTube.organ_end - kTube.far_end;
  for (const double angle : {0.5, -0.5}) {
    const HoldTurn turn = TakeRound(kHold, kTube, at_rest, angle);
    const Vec3 held = kHold.tip + turn.by;
    EXPECT_NEAR(std::hypot(held.y, held.z), 0.020, 1e-12);
    EXPECT_NEAR(held.x, 0.030, 1e-12);
    EXPECT_NEAR(std::atan2(-held.y, held.z), angle, 1e-12);
  }
}

TEST(TakeRound, DrawsAFoldedTubeOutFirst) {
  const TurnAxis folded{{0.010, 0, 0}, {0, 0, 0}};
  const HoldPose hold{{0.010, 0, 0.15}, {0.010, 0, 0.020}};
  const HoldTurn turn = TakeRound(hold, folded, {0.030, 0, 0}, 0.0);
  EXPECT_LT(math::Distance(turn.by, {0.020, 0, 0}), 1e-12);
}

}  // namespace
}  // namespace trocar::agent
