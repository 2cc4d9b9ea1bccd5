// SPDX-License-Identifier: Apache-2.0
#include "image_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace trocar::images {
namespace {

using base::ErrorCode;
using math::Vec3;
using Axes = std::array<std::string, 3>;

/// Unit vectors turned about the patient's long axis.
std::array<Vec3, 3> Turned(double degrees) {
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
  return {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
}

// Every one of the 48 ways to lay three axes along a body is named and found again.
TEST(NameAxes, InvertsFindDirections) {
  const std::array<std::array<const char*, 2>, 3> words = {
      {{"left", "right"}, {"anterior", "posterior"}, {"superior", "inferior"}}};
  std::array<std::size_t, 3> order = {0, 1, 2};
  int count = 0;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      const Axes axes = {words[order[0]][signs & 1], words[order[1]][signs >> 1 & 1],
                         words[order[2]][signs >> 2 & 1]};
      const auto direction = FindDirections(axes);
      ASSERT_TRUE(direction.ok());
      const auto named = NameAxes(*direction);
      ASSERT_TRUE(named.ok());
      EXPECT_EQ(named->axes, axes);
      EXPECT_NEAR(named->tilt_deg, 0, 1e-9);
      ++count;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(count, 48);
}

TEST(NameAxes, KnowsTheDicomFrame) {
  // columns of an ordinary axial slice run to the patient's left, rows to the back
  EXPECT_EQ(NameAxes(Turned(0))->axes, (Axes{"left", "posterior", "superior"}));
}

TEST(NameAxes, AcceptsALittleTilt) {
  const auto named = NameAxes(Turned(15));
  ASSERT_TRUE(named.ok());
  EXPECT_EQ(named->axes, (Axes{"left", "posterior", "superior"}));
  EXPECT_NEAR(named->tilt_deg, 15, 1e-9);
  EXPECT_EQ(NameAxes(Turned(25)).error().code, ErrorCode::kImageGeometryInvalid);
  EXPECT_EQ(NameAxes(Turned(45)).error().code, ErrorCode::kImageGeometryInvalid);
}

TEST(NameAxes, RefusesShear) {
  auto axes = Turned(0);
  axes[2] = Normalized(Vec3{0, 0.1, 1});
  EXPECT_EQ(NameAxes(axes).error().code, ErrorCode::kImageGeometryInvalid);
}

TEST(FindDirections, RefusesWordsThatDoNotSpanTheBody) {
  EXPECT_FALSE(FindDirections({"left", "right", "superior"}).ok());
  EXPECT_FALSE(FindDirections({"left", "anterior", "up"}).ok());
  EXPECT_FALSE(FindDirections({"", "", ""}).ok());
}

}  // namespace
}  // namespace trocar::images
