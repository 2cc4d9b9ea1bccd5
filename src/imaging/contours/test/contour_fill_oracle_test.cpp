// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_fill.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

// even-odd rule at the same pixel centre, straight from its definition
bool IsInside(const std::vector<Vec2>& contour, double x, double y) {
  bool inside = false;
  for (std::size_t i = 0, j = contour.size() - 1; i < contour.size(); j = i++) {
    const Vec2 &a = contour[i], &b = contour[j];
    if ((a.y > y) != (b.y > y) && x < (b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x) inside = !inside;
  }
  return inside;
}

TEST(FillContour, EqualsTheEvenOddRuleForRandomStars) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    math::Random random(seed);
    const int n = 3 + static_cast<int>(random.Uniform(0, 40));
    std::vector<Vec2> contour;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * i / n, radius = random.Uniform(0.5, 20);
      Vec2 p{25 + radius * std::cos(angle), 25 + radius * std::sin(angle)};
      // half of the contours have whole-number corners, which lie exactly on pixel centres
      if (seed % 2 == 0) p = {std::round(p.x), std::round(p.y)};
      contour.push_back(p);
    }
    images::Mask mask{0, 0, 50, 50, std::vector<std::uint8_t>(2500, 0)};
    FillContour(contour, mask);
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 50; ++x) {
        ASSERT_EQ(mask.At(x, y) != 0, IsInside(contour, x + 1.3e-7, y + 2.9e-7))
            << "seed " << seed << " at " << x << ", " << y;
      }
    }
  }
}

TEST(FillContour, FindsAPocketNarrowerThanAPixel) {
  // a C whose mouth passes between two columns of centres: its inside is still outside
  const std::vector<Vec2> contour = {{2.5, 2.5},  {20.5, 2.5}, {20.5, 9.4},  {10.5, 9.4},
                                     {10.5, 6.5}, {6.5, 6.5},  {6.5, 14.5},  {10.5, 14.5},
                                     {10.5, 9.6}, {20.5, 9.6}, {20.5, 18.5}, {2.5, 18.5}};
  images::Mask mask{0, 0, 24, 24, std::vector<std::uint8_t>(576, 0)};
  FillContour(contour, mask);
  EXPECT_EQ(mask.At(8, 10), 0);
  EXPECT_EQ(mask.At(4, 10), 1);
  EXPECT_EQ(mask.At(15, 9), 1);
  EXPECT_EQ(mask.At(0, 0), 0);
}

TEST(FillArea, CutsHolesAndUnitesContours) {
  const std::vector<Vec2> big = {{10.5, 10.5}, {30.5, 10.5}, {30.5, 30.5}, {10.5, 30.5}};
  const std::vector<Vec2> overlapping = {{25.5, 15.5}, {40.5, 15.5}, {40.5, 20.5}, {25.5, 20.5}};
  const std::vector<Vec2> hole = {{12.5, 12.5}, {16.5, 12.5}, {16.5, 16.5}, {12.5, 16.5}};
  EXPECT_EQ(FillArea({big}, {}).Count(), 400u);
  EXPECT_EQ(FillArea({big, overlapping}, {}).Count(), 400u + 50u);
  EXPECT_EQ(FillArea({big, overlapping}, {hole}).Count(), 434u);
  EXPECT_EQ(FillArea({}, {}).Count(), 0u);
}

}  // namespace
}  // namespace trocar::contours
