// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/sweep.h"
#include "random_triangles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::collision {

using math::Vec3;

namespace {

Segment RandomSegment(math::Random& random, double reach) {
  return {RandomPoint(random, reach), RandomPoint(random, reach)};
}

constexpr int kSamples = 2000;

/// First of many times at which the distance is at most `reach`, or above 1.
template <typename Distance>
double FindFirstSample(double reach, const Distance& distance) {
  for (int i = 0; i <= kSamples; ++i) {
    const double time = static_cast<double>(i) / kSamples;
    if (distance(time) <= reach) return time;
  }
  return 2.0;
}

// The brute force over time: no sample lies within reach before the sweep says so, and what it calls a touch is
// one.
TEST(SweepToTriangle, NeverLaterThanDenseSamplingAndNeverEarlierThanTheTolerance) {
  math::Random random(41);
  int hits = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const MovingSegment tool{RandomSegment(random, 0.05), RandomSegment(random, 0.05)};
    MovingTriangle triangle;
    const Vec3 shift = RandomPoint(random, 0.03);
    for (int i = 0; i < 3; ++i) {
      triangle.from[i] = RandomPoint(random, trial % 3 == 0 ? 0.003 : 0.02) + shift;
      triangle.to[i] = triangle.from[i] + RandomPoint(random, 0.02);
    }
    if (trial % 7 == 0) triangle.from[2] = triangle.from[1], triangle.to[2] = triangle.to[1];
    const double reach = trial % 2 == 0 ? 0.0025 : 0.0;
    const auto distance = [&](double time) {
      const Segment s = tool.At(time);
      const auto t = triangle.At(time);
      return std::sqrt(FindNearestSegmentTriangle(s.start, s.end, t[0], t[1], t[2]).squared_distance);
    };
    const TriangleSweep sweep = SweepToTriangle(tool, triangle, reach);
    const double sampled = FindFirstSample(reach, distance);
    if (sweep.is_hit) {
      ++hits;
      EXPECT_LE(sweep.time, sampled + 1e-12) << trial;
      EXPECT_LE(distance(sweep.time), reach + 1.01 * kSweepTolerance) << trial;
    } else {
      EXPECT_GT(sampled, 1.0) << trial;
      EXPECT_NEAR(std::sqrt(sweep.points.squared_distance), distance(1.0), 1e-12);
    }
  }
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, 350);
}

TEST(SweepToSegment, NeverLaterThanDenseSamplingAndNeverEarlierThanTheTolerance) {
  math::Random random(42);
  int hits = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const MovingSegment tool{RandomSegment(random, 0.05), RandomSegment(random, 0.05)};
    MovingSegment duct{RandomSegment(random, 0.03), {}};
    duct.to = {duct.from.start + RandomPoint(random, 0.02), duct.from.end + RandomPoint(random, 0.02)};
    const double reach = trial % 2 == 0 ? 0.004 : 0.0005;
    const auto distance = [&](double time) {
      return std::sqrt(FindNearestSegmentSegment(tool.At(time), duct.At(time)).squared_distance);
    };
    const TubeSweep sweep = SweepToSegment(tool, duct, reach);
    const double sampled = FindFirstSample(reach, distance);
    hits += sweep.is_hit;
    if (sweep.is_hit) {
      EXPECT_LE(sweep.time, sampled + 1e-12) << trial;
      EXPECT_LE(distance(sweep.time), reach + 1.01 * kSweepTolerance) << trial;
    } else {
      EXPECT_GT(sampled, 1.0) << trial;
    }
  }
  EXPECT_GT(hits, 50);
}

// The figure of the task: a tip at 2 m/s, 120 ticks a second, a duct 3 mm thick. 16.7 mm lie between two ticks.
TEST(SweepToSegment, ATipAtTwoMetresASecondNeverPassesADuctBetweenTwoTicks) {
  math::Random random(43);
  constexpr double kTick = 1.0 / 120, kSpeed = 2.0, kDuct = 0.0015, kTool = 0.0025;
  int unseen_by_ticks = 0;
  for (int trial = 0; trial < 500; ++trial) {
    // the duct lies across the tip's way somewhere between the two ticks
    const Vec3 from = RandomPoint(random, 0.05);
    const Vec3 heading = math::Normalized(RandomPoint(random, 1.0));
    const Vec3 to = from + kSpeed * kTick * heading;
    const Vec3 crossing = math::Lerp(from, to, random.Uniform(0.3, 0.7));
    const Vec3 across = math::Normalized(math::Cross(heading, RandomPoint(random, 1.0)));
    const Segment axis{crossing - 0.02 * across, crossing + 0.03 * across};
    const TubeSweep sweep = SweepToSegment({{from, from}, {to, to}}, {axis, axis}, kDuct + kTool);
    ASSERT_TRUE(sweep.is_hit) << trial;
    // the tip has not reached the duct's axis yet
    EXPECT_LT(sweep.time * math::Distance(from, to), math::Distance(from, crossing) - 0.9 * (kDuct + kTool));
    const auto gap = [&](const Vec3& tip) {
      return std::sqrt(FindNearestSegmentSegment({tip, tip}, axis).squared_distance) - kDuct - kTool;
    };
    unseen_by_ticks += gap(from) > 0.0 && gap(to) > 0.0;
  }
  EXPECT_GT(unseen_by_ticks, 400) << "looking at the two ticks alone sees none of these";
}

// Analytic: straight towards a plate, along it, and away from it.
TEST(SweepToTriangle, KnowsTheMomentOfAStraightApproach) {
  const MovingTriangle plate{{Vec3{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}},
                             {Vec3{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}};
  const auto tip = [](const Vec3& from, const Vec3& to) { return MovingSegment{{from, from}, {to, to}}; };
  const TriangleSweep hit = SweepToTriangle(tip({0, 0, 0.10}, {0, 0, -0.10}), plate, 0.02);
  EXPECT_TRUE(hit.is_hit);
  EXPECT_NEAR(hit.time, 0.4, 2e-5);
  EXPECT_FALSE(SweepToTriangle(tip({0, 0, 0.03}, {0.5, 0, 0.03}), plate, 0.02).is_hit);
  EXPECT_FALSE(SweepToTriangle(tip({0, 0, 0.03}, {0, 0, 0.1}), plate, 0.02).is_hit);
  EXPECT_EQ(SweepToTriangle(tip({0, 0, 0.01}, {0, 0, 0.1}), plate, 0.02).time, 0.0) << "touches at once";
  // a plate that comes up to a tip at rest
  MovingTriangle rising = plate;
  for (Vec3& p : rising.to) p.z += 0.1;
  EXPECT_NEAR(SweepToTriangle(tip({0, 0, 0.07}, {0, 0, 0.07}), rising, 0.02).time, 0.5, 2e-5);
}

TEST(CalcSweptCapsule, HoldsEveryPlaceOfTheTool) {
  math::Random random(44);
  for (int trial = 0; trial < 100; ++trial) {
    const MovingSegment tool{RandomSegment(random, 0.1), RandomSegment(random, 0.1)};
    const Capsule swept = CalcSweptCapsule(tool, 0.003);
    for (int i = 0; i <= 20; ++i) {
      const Segment at = tool.At(i / 20.0);
      for (int j = 0; j <= 20; ++j) {
        const Vec3 p = math::Lerp(at.start, at.end, j / 20.0);
        const double away = std::sqrt(FindNearestSegmentSegment({p, p}, swept.axis).squared_distance);
        EXPECT_LE(away + 0.003, swept.radius + 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace trocar::collision
