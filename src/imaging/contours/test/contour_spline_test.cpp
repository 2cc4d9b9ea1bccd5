// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

TEST(FitContour, FollowsACircle) {
  std::vector<Vec2> points;
  for (int i = 0; i < 12; ++i)
    points.push_back({50 + 30 * std::cos(i * M_PI / 6), 40 + 30 * std::sin(i * M_PI / 6)});
  for (const Vec2& p : FitContour(points)) EXPECT_NEAR(Norm(p - Vec2{50, 40}), 30.0, 0.02);
}

TEST(FitContour, DividesWhereTheSplineSwingsOut) {
  // two points side by side after long chords make a cubic spline loop
  const std::vector<Vec2> points = {{0, 0}, {100, 0}, {101, 2}, {100, 4}, {0, 60}, {-2, 30}};
  const auto free = FitContour(points, {.max_bulge = 1e9});
  const auto held = FitContour(points);
  const auto highest = [](const std::vector<Vec2>& curve) {
    double x = 0;
    for (const Vec2& p : curve) x = std::max(x, p.x);
    return x;
  };
  EXPECT_FALSE(CrossesItself(held));
  EXPECT_LE(highest(held), 104.0);
  EXPECT_LE(highest(held), highest(free));
}

TEST(FitContour, PassesThroughItsPoints) {
  const std::vector<Vec2> points = {{0, 0}, {10, -3}, {22, 1}, {25, 12}, {11, 9}, {2, 14}};
  const auto curve = FitContour(points);
  for (const Vec2& p : points) {
    double nearest = 1e9;
    for (const Vec2& q : curve) nearest = std::min(nearest, Norm(p - q));
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(FitContour, NeverCrossesItselfWhereThePolygonDoesNot) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    math::Random random(seed);
    const int n = 4 + static_cast<int>(random.Uniform(0, 30));
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * (i + random.Uniform(0, 0.8)) / n, radius = random.Uniform(3, 40);
      points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    if (CrossesItself(points)) continue;
    EXPECT_FALSE(CrossesItself(FitContour(points))) << "seed " << seed;
  }
}

TEST(CrossesItself, TellsAFigureEightFromASquare) {
  const std::vector<Vec2> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, eight = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  EXPECT_FALSE(CrossesItself(square));
  EXPECT_TRUE(CrossesItself(eight));
}

}  // namespace
}  // namespace trocar::contours
