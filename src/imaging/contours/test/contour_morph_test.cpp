// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_morph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/contours/contour_fill.h"

namespace trocar::contours {

using math::Vec2;

namespace {

std::vector<Vec2> MakeCircle(double cx, double cy, double radius) {
  std::vector<Vec2> circle;
  for (int i = 0; i < 180; ++i)
    circle.push_back({cx + radius * std::cos(i * M_PI / 90), cy + radius * std::sin(i * M_PI / 90)});
  return circle;
}

TEST(MatchContours, MovesAndGrowsACircleEvenly) {
  auto second = MakeCircle(66, 40, 24);
  std::reverse(second.begin(), second.end());  // the other sense of rotation is no other shape
  const auto match = MatchContours(MakeCircle(60, 40, 20), second);
  for (const double t : {0.25, 0.5, 0.75}) {
    const double expected = M_PI * std::pow(20 + 4 * t, 2);
    EXPECT_NEAR(static_cast<double>(FillArea({match.At(t)}, {}).Count()), expected, 0.04 * expected) << t;
  }
}

TEST(MatchContours, KeepsAThinLobeThatMovesSidewaysByMoreThanItsThickness) {
  const auto lobe = [](double tip_x, double tip_y) {
    return std::vector<Vec2>{{10, 10},           {40, 10}, {40, 30}, {tip_x, tip_y},
                             {tip_x, tip_y + 3}, {40, 36}, {40, 70}, {10, 70}};
  };
  const auto match = MatchContours(lobe(90, 30), lobe(80, 42));
  double furthest = 0;
  for (const Vec2& p : match.At(0.5)) furthest = std::max(furthest, p.x);
  EXPECT_NEAR(furthest, 85, 2.0);
  // filled out to its tip
  const images::Mask mask = FillArea({match.At(0.5)}, {});
  int row_pixels = 0;
  for (int y = 0; y < mask.height; ++y) row_pixels += mask.At(78 - mask.x0, y);
  EXPECT_GE(row_pixels, 2);
}

}  // namespace
}  // namespace trocar::contours
