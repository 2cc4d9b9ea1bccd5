// SPDX-License-Identifier: Apache-2.0
// Clips and cuts of two made-up vessels, by tools that stand where the test puts them.
#include "division_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planner_hands.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

constexpr double kLength = 0.034, kRadius = 0.00125;
const Vec3 kPort{0.017, 0, 0.15};

/// Along x, the second 20 mm beside the first.
SeenVessels TwoVessels() {
  SeenVessels vessels;
  for (const double y : {0.0, 0.020}) {
    TubeLine line;
    for (int i = 0; i <= 17; ++i) {
      line.points.push_back({kLength * i / 17, y, 0});
      line.radii.push_back(kRadius);
    }
    vessels.lines.push_back(line);
  }
  vessels.clips.resize(2);
  vessels.is_divided = {0, 0};
  vessels.port = kPort;
  vessels.clearance = [](const collision::Segment&) { return 0.05; };
  return vessels;
}

Division BothOf() {
  Division work;
  work.tubes = {0, 1};
  work.avoid.resize(2);
  return work;
}

/// A tool whose jaws have a point between them, as far from the tips as the aim says.
Pose ToolAround(const Vec3& p, const JawAim& aim, double jaw_length) {
  const Vec3 tip = aim.FindTip(kPort, p, jaw_length);
  return instrument::CalcToolPose(kPort, instrument::FindJoints(kPort, tip, 0.0, 0.0));
}

const double kLegs = instrument::FindTool("clip_applier")->jaw_length,
             kBlades = instrument::FindTool("scissors")->jaw_length;

TEST(DivisionPlanner, PutsAllClipsBeforeTheFirstCutAndEnds) {
  SeenVessels vessels = TwoVessels();
  const Division work = BothOf();
  int clips = 0, cuts = 0;
  for (int step = 0; step < 20; ++step) {
    const auto next = FindNext(vessels, work);
    if (!next) break;
    const std::size_t tube = work.tubes[next->which];
    if (next->step.kind == DivisionStep::Kind::kClip) {
      EXPECT_EQ(cuts, 0) << "each tool is taken once";
      vessels.clips[tube].push_back(next->step.arc);
      std::sort(vessels.clips[tube].begin(), vessels.clips[tube].end());
      ++clips;
    } else {
      EXPECT_EQ(clips, 6);
      vessels.is_divided[tube] = 1;
      ++cuts;
    }
  }
  EXPECT_EQ(clips, 6);
  EXPECT_EQ(cuts, 2);
  EXPECT_FALSE(FindNext(vessels, work));
}

TEST(DivisionPlanner, TriesNoClipNearOneThatWasNotSeen) {
  const SeenVessels vessels = TwoVessels();
  Division work = BothOf();
  const auto first = FindNext(vessels, work);
  ASSERT_TRUE(first);
  AvoidAround(work, first->which, first->step.arc);
  const auto second = FindNext(vessels, work);
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->which != first->which || std::fabs(second->step.arc - first->step.arc) > kLeastGap);
}

TEST(JawAim, BringsTheVesselBetweenTheJawsAndCorrectsAPush) {
  JawAim aim;
  const Vec3 p{0.017, 0, 0};
  const Pose X = ToolAround(p, aim, kLegs);
  EXPECT_LT(math::Distance(X * Vec3{0, 0, aim.beyond * kLegs}, p), 1e-9);
  // pushed aside by 2 mm, the hand aims as far to the other side
  Pose pushed = X;
  pushed.translation += Vec3{0.002, 0, 0};
  aim.Correct(pushed, p, kLegs);
  EXPECT_LT(math::Distance(aim.offset, {-0.002, 0, 0}), 1e-9);
  // by 4 mm at most
  pushed.translation += Vec3{0.050, 0, 0};
  aim.Correct(pushed, p, kLegs);
  EXPECT_NEAR(math::Norm(aim.offset), 0.004, 1e-12);
}

TEST(LineUpClip, StandsBeforeTheVesselWithOpenLegs) {
  const SeenVessels vessels = TwoVessels();
  JawAim aim;
  aim.offset = {1, 1, 1};
  const HandGoal goal = LineUpClip(vessels, 0, 0.017, 1.0, aim);
  ASSERT_TRUE(goal.tip && goal.jaw);
  EXPECT_NEAR(goal.tip->z, 0.012, 1e-9);
  EXPECT_EQ(*goal.jaw, instrument::FindTool("clip_applier")->max_jaw);
  EXPECT_EQ(math::Norm(aim.offset), 0.0);
}

TEST(LineUpScissors, AreNotTakenWhereTheyCannotCut) {
  SeenVessels vessels = TwoVessels();
  JawAim aim;
  EXPECT_TRUE(LineUpScissors(vessels, 0, 0.017, 1.0, aim));
  vessels.clearance = [](const collision::Segment&) { return 0.0; };
  EXPECT_FALSE(LineUpScissors(vessels, 0, 0.017, 1.0, aim));
}

TEST(IsBetweenLegs, AsksForThisVesselAloneAndNoOtherClip) {
  SeenVessels vessels = TwoVessels();
  const Vec3 p{0.017, 0, 0};
  const Pose X = ToolAround(p, {}, kLegs);
  EXPECT_TRUE(IsBetweenLegs(vessels, 0, X, 1.0));
  EXPECT_FALSE(IsBetweenLegs(vessels, 1, X, 1.0)) << "the other one is not there";
  Pose before = X;
  before.translation += Vec3{0, 0, 0.030};
  EXPECT_FALSE(IsBetweenLegs(vessels, 0, before, 1.0)) << "the legs do not reach it";
  vessels.clips[0] = {0.0175};
  EXPECT_FALSE(IsBetweenLegs(vessels, 0, X, 1.0)) << "over another clip";
  vessels.clips[0].clear();
  for (Vec3& point : vessels.lines[1].points) point.y = 0.0006;
  EXPECT_FALSE(IsBetweenLegs(vessels, 0, X, 1.0)) << "two vessels between the legs";
  vessels.is_divided[1] = 1;
  EXPECT_TRUE(IsBetweenLegs(vessels, 0, X, 0.7)) << "a stump gives way";
}

TEST(IsCutSafe, WantsOneClipBeforeTheCutAndTwoBehind) {
  SeenVessels vessels = TwoVessels();
  const Pose X = ToolAround({0.017, 0, 0}, {}, kBlades);
  const auto is_safe = [&](std::vector<double> clips) {
    vessels.clips[0] = std::move(clips);
    return IsCutSafe(vessels, 0, X);
  };
  EXPECT_TRUE(is_safe({0.010, 0.022, 0.026}));
  EXPECT_FALSE(is_safe({0.010, 0.022}));
  EXPECT_FALSE(is_safe({0.022, 0.026}));
  EXPECT_FALSE(is_safe({0.004, 0.010, 0.022}));
}

}  // namespace
}  // namespace trocar::agent
