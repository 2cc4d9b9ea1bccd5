// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/intelligent_scissors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "phantom_picture.h"

namespace trocar::contours {

using math::Vec2;

namespace {

const Vec2 kCentre{80, 80};
constexpr double kRadius = 45.0;

double RadiusOf(const Vec2& p) {
  return Norm(p - kCentre);
}

images::ColorImage MakeDisc(double noise) {
  return DrawPhantom({.noise = noise, .seed = 3}, [](double x, double y) {
    return RadiusOf({x, y}) - kRadius;
  });
}

TEST(IntelligentScissors, GoesAroundADiscAndNotThroughIt) {
  for (const double noise : {0.0, 10.0}) {
    IntelligentScissors scissors(MakeDisc(noise));
    scissors.SetSeed({80 + kRadius, 80});
    const auto path = scissors.PathTo({80, 80 - kRadius});
    ASSERT_GT(path.size(), 40u);
    for (const Vec2& p : path) EXPECT_NEAR(RadiusOf(p), kRadius, 1.6) << "noise " << noise;
    for (std::size_t i = 1; i < path.size(); ++i) {
      EXPECT_LE(std::fabs(path[i].x - path[i - 1].x), 1.0);
      EXPECT_LE(std::fabs(path[i].y - path[i - 1].y), 1.0);
    }
    EXPECT_EQ(path.front(), (Vec2{125, 80}));
    EXPECT_EQ(path.back(), (Vec2{80, 35}));
  }
}

TEST(IntelligentScissors, GoesStraightWhereThereIsNoEdge) {
  IntelligentScissors scissors(images::ColorImage{60, 60, std::vector<std::uint8_t>(60 * 60 * 3, 90)});
  scissors.SetSeed({5, 10});
  const auto path = scissors.PathTo({50, 10});
  ASSERT_EQ(path.size(), 46u);
  for (const Vec2& p : path) EXPECT_EQ(p.y, 10.0);
}

TEST(IntelligentScissors, IsEmptyWithoutASeedAndStraightBeyondReach) {
  IntelligentScissors scissors(MakeDisc(0), {.reach_px = 20});
  EXPECT_TRUE(scissors.PathTo({10, 10}).empty());
  scissors.SetSeed({80, 80});
  const auto path = scissors.PathTo({150, 80});
  EXPECT_EQ(path.front(), (Vec2{80, 80}));
  EXPECT_EQ(path.back(), (Vec2{150, 80}));
  EXPECT_EQ(path.size(), 71u);
  // outside of the picture: the border
  EXPECT_EQ(scissors.PathTo({-500, 1e6}).back(), (Vec2{0, 159}));
}

TEST(SimplifyPath, KeepsCornersWithinTheTolerance) {
  std::vector<Vec2> path;
  for (int i = 0; i <= 20; ++i) path.push_back({static_cast<double>(i), 0});
  for (int i = 1; i <= 20; ++i) path.push_back({20, static_cast<double>(i)});
  EXPECT_EQ(SimplifyPath(path), (std::vector<Vec2>{{0, 0}, {20, 0}, {20, 20}}));
  EXPECT_EQ(SimplifyPath(std::vector<Vec2>{{1, 2}, {3, 4}}).size(), 2u);
  // an arc: every point stays within the tolerance of the polyline that is left
  path.clear();
  for (int i = 0; i <= 200; ++i) path.push_back({50 * std::cos(i * 0.01), 50 * std::sin(i * 0.01)});
  const auto kept = SimplifyPath(path, 0.5);
  EXPECT_LT(kept.size(), 20u);
  for (const Vec2& p : path) {
    double nearest = 1e9;
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      const Vec2 chord = kept[i + 1] - kept[i];
      const double t = std::clamp(Dot(p - kept[i], chord) / Dot(chord, chord), 0.0, 1.0);
      nearest = std::min(nearest, Norm(p - kept[i] - t * chord));
    }
    EXPECT_LE(nearest, 0.5 + 1e-9);
  }
}

}  // namespace
}  // namespace trocar::contours
