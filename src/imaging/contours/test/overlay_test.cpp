// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/overlay.h"

#include <gtest/gtest.h>

#include <vector>

#include "trocar/contours/contour_fill.h"

namespace trocar::contours {
namespace {

TEST(DrawOverlay, ShowsTheStagesInTheirColours) {
  images::ColorImage photograph{100, 100, std::vector<std::uint8_t>(30000, 100)};
  Overlay overlay;
  overlay.contours = {{{{40, 40}, {60, 40}, {60, 60}, {40, 60}},
                       {{42, 42}, {58, 42}, {58, 58}, {42, 58}},
                       {{45, 45}, {55, 45}, {55, 55}, {45, 55}}}};
  overlay.areas = {FillArea({{{45, 45}, {55, 45}, {55, 55}, {45, 55}}}, {})};
  overlay.tube_points = {{50, 50}};
  const images::ColorImage picture = DrawOverlay(photograph, overlay, 2);
  // the crop starts 30 pixels before the first point
  const auto at = [&](int x, int y) { return picture.At((x - 10) * 2, (y - 10) * 2); };
  EXPECT_GT(at(40, 40)[0], 200);
  EXPECT_LT(at(40, 40)[1], 100);
  EXPECT_GT(at(58, 58)[1], 200);
  EXPECT_GT(at(58, 58)[0], 200);
  EXPECT_GT(picture.At(81, 81)[2], 200);  // the cross in the middle of pixel (50, 50)
  EXPECT_GT(at(48, 53)[0], 110);
  EXPECT_EQ(at(30, 30)[0], 100);
}

}  // namespace
}  // namespace trocar::contours
