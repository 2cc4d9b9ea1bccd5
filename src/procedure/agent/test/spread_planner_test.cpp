// SPDX-License-Identifier: Apache-2.0
// The dissector and the scissors at work on a made-up row of fibres.
#include "spread_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner_hands.h"
#include "trocar/collision/segment_distance.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

/// Upright fibres, 2 mm apart, that opening jaws part and closing blades cut.
struct Row {
  std::vector<collision::Segment> fibres;
  std::vector<std::uint8_t> is_intact;
  Spreading work;
  HandMotion hand = HandAt({0.01, 0.15, 0}, {0.01, 0.03, 0});
  SpreadSight sight;
  double seconds = 0;
  double widest = 0;  // that the jaws were opened, as a share
  bool parts = true;

  Row(int count, bool is_sharp) {
    for (int i = 0; i < count; ++i) {
      const double x = 0.002 * i;
      fibres.push_back({{x, 0, -0.002}, {x, 0, 0.002}});
      work.strands.push_back(static_cast<std::uint32_t>(i));
    }
    is_intact.assign(fibres.size(), 1);
    work.weights.assign(fibres.size(), 1.0);
    work.tries.assign(fibres.size(), 0);
    work.is_sharp = is_sharp;
    sight.is_intact = is_intact;
    sight.is_clear = [] { return false; };
    sight.look = [this](const Spreading& now) {
      SeenSpread seen;
      for (const std::uint32_t i : now.strands) {
        if (is_intact[i] == 0) continue;
        seen.field.fibres.push_back(fibres[i]);
        seen.field.weights.push_back(now.weights[i]);
        seen.index.push_back(i);
      }
      seen.field.port = hand.Port();
      seen.field.tip = hand.Tip();
      seen.field.spin = hand.Spin();
      seen.field.tool = &FindSpreadTool(now);
      seen.field.clearance = [](const collision::Segment&) { return 0.05; };
      return seen;
    };
  }
  std::size_t Left() const {
    return static_cast<std::size_t>(std::count(is_intact.begin(), is_intact.end(), 1));
  }
  /// Parts what the jaws sweep as they open, or shut on.
  void Part(const Pose& X_world_tool) {
    const instrument::Tool& tool = FindSpreadTool(work);
    const double now = hand.Jaw() / tool.max_jaw;
    widest = std::max(widest, now);
    const bool sweeps = work.is_sharp ? now < 0.05 : now > 0.4;
    if (!parts || !sweeps) return;
    const Pose X_tool_world = math::Inverse(X_world_tool);
    for (std::size_t i = 0; i < fibres.size(); ++i) {
      const Vec3 a = X_tool_world * fibres[i].start, b = X_tool_world * fibres[i].end;
      if ((a.x > 0) == (b.x > 0)) continue;
      const Vec3 p = math::Lerp(a, b, a.x / (a.x - b.x));
      const double along = tool.jaw_length - p.z, reach = std::hypot(along, p.y);
      const double angle = std::atan2(std::fabs(p.y), along);
      const bool is_cut = reach < tool.jaw_length && std::fabs(p.y) < 0.004;
      const bool is_swept = reach < tool.jaw_length && angle < 0.5 * hand.Jaw();
      if (along > 0 && (work.is_sharp ? is_cut : is_swept)) is_intact[i] = 0;
    }
  }
  bool Play(double most_seconds) {
    for (double time = 0; time < most_seconds; time += kTestTick, seconds += kTestTick) {
      if (StepSpreading(sight, work, seconds, hand)) return true;
      sight.X_world_tool = StepTool(hand);
      Part(sight.X_world_tool);
    }
    return false;
  }
};

TEST(SpreadPlanner, PartsTheRowByOpeningAmongIt) {
  Row row(9, false);
  EXPECT_TRUE(row.Play(120));
  EXPECT_LE(row.Left(), 2u);
  EXPECT_GT(row.widest, 0.4);
}

TEST(SpreadPlanner, GivesUpWhereNothingParts) {
  Row row(9, false);
  row.parts = false;
  EXPECT_TRUE(row.Play(120));
  EXPECT_EQ(row.Left(), 9u);
  EXPECT_GE(row.work.fruitless, 1);
  EXPECT_GE(*std::max_element(row.work.tries.begin(), row.work.tries.end()), 1);
}

TEST(SpreadPlanner, StopsWhereNothingMoreIsToBeParted) {
  Row row(9, false);
  row.sight.is_clear = [] { return true; };
  EXPECT_TRUE(row.Play(1));
  EXPECT_EQ(row.Left(), 9u);
  EXPECT_FALSE(row.hand.IsMoving());
}

TEST(SpreadPlanner, CutsFibresOneByOne) {
  Row row(2, true);
  EXPECT_TRUE(row.Play(120));
  EXPECT_EQ(row.Left(), 0u);
}

TEST(SpreadPlanner, BladesThatWerePushedAsideDoNotClose) {
  Row row(1, true);
  const auto step = [&](const Vec3& push) {
    const bool is_over = StepSpreading(row.sight, row.work, row.seconds, row.hand);
    row.sight.X_world_tool = StepTool(row.hand);
    row.sight.X_world_tool.translation += push;
    return is_over;
  };
  for (int tick = 0; tick < 20000 && !step({0, 0.006, 0}); ++tick) {
    EXPECT_NE(row.work.stage, Spreading::Stage::kOpen);
  }
  EXPECT_EQ(row.work.tries[0], 3);
}

}  // namespace
}  // namespace trocar::agent
