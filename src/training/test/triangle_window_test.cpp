// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/triangle_window.h"

#include <gtest/gtest.h>

#include <vector>

namespace trocar::training {

using math::Vec3;
namespace {

constexpr TriangleWindowSettings kSettings{0.005, 0.002};

/// A right angle between a cystic duct of 30 mm along x and a hepatic duct of 20 mm along y, which goes on downwards as
/// the common bile duct.
TriangleBorders MakeBorders() {
  TriangleBorders borders;
  for (int i = 0; i <= 15; ++i) borders.cystic_duct.push_back({0.002 * i, 0, 0});
  for (int i = 0; i <= 10; ++i) borders.hepatic_duct.push_back({0, 0.002 * i, 0});
  borders.main_ducts = borders.hepatic_duct;
  for (int i = 1; i <= 10; ++i) borders.main_ducts.push_back({0, -0.002 * i, 0});
  return borders;
}

/// A lump of fat of so many strands about a point.
std::vector<TriangleFat> MakeLump(const Vec3& middle, std::uint32_t count) {
  std::vector<TriangleFat> fat;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 aside{0.0004 * (i % 3), 0.0004 * (i % 5), 0.0004 * (i % 7)};
    fat.push_back({i, {middle + aside, middle + aside + Vec3{0.0005, 0.0005, 0.0005}}});
  }
  return fat;
}

double OpenShare(const std::vector<TriangleFat>& fat) {
  const TriangleWindow window(MakeBorders(), fat, kSettings);
  return window.CalcOpenShare(std::vector<std::uint8_t>(fat.size(), 1));
}

TEST(TriangleWindow, IsTheTriangleLessTheBorderBesideTheMainDuct) {
  const TriangleWindow window(MakeBorders(), {}, kSettings);
  // what is left is a triangle of 25 mm by 16.7 mm
  EXPECT_NEAR(window.Area(), 0.5 * 0.025 * 0.025 * 20 / 30, 15e-6);
  EXPECT_EQ(window.CalcOpenShare({}), 1.0);
}

TEST(TriangleWindow, ALumpOverTheTriangleNearTheMainDuctCovers) {
  // 7 mm beside the hepatic duct
  const double open = OpenShare(MakeLump({0.007, 0.006, 0}, 20));
  EXPECT_LT(open, 0.95);
  EXPECT_GT(open, 0.6);
}

TEST(TriangleWindow, WhatLiesBeforeOrBehindCoversAlike) {
  const double open = OpenShare(MakeLump({0.010, 0.004, 0}, 10));
  EXPECT_LT(open, 1.0);
  EXPECT_EQ(OpenShare(MakeLump({0.010, 0.004, 0.008}, 10)), open);
  EXPECT_EQ(OpenShare(MakeLump({0.010, 0.004, -0.008}, 10)), open);
}

TEST(TriangleWindow, FatOnAndBeyondTheMainDuctAndBelowTheCysticDuctMayStay) {
  EXPECT_EQ(OpenShare(MakeLump({0, 0.010, 0}, 20)), 1.0);
  EXPECT_EQ(OpenShare(MakeLump({-0.010, 0.010, 0}, 20)), 1.0);
  EXPECT_EQ(OpenShare(MakeLump({0.015, -0.006, 0}, 20)), 1.0);
}

TEST(TriangleWindow, OpensOnlyWhenTheLastStrandOverAPatchIsDivided) {
  const std::vector<TriangleFat> fat = MakeLump({0.010, 0.004, 0}, 2);
  const TriangleWindow window(MakeBorders(), fat, kSettings);
  EXPECT_EQ(window.Strands(), (std::vector<std::uint32_t>{0, 1}));
  const double covered = 1.0 - window.CalcOpenShare(std::vector<std::uint8_t>{1, 1});
  const double by_one = 1.0 - window.CalcOpenShare(std::vector<std::uint8_t>{0, 1});
  EXPECT_GT(by_one, 0.5 * covered) << "one of two in the same place hides nearly as much";
  EXPECT_EQ(window.CalcOpenShare(std::vector<std::uint8_t>{0, 0}), 1.0);
}

TEST(TriangleWindow, ATriangleNarrowerThanTheBorderIsAllWindow) {
  TriangleBorders borders = MakeBorders();
  for (Vec3& p : borders.cystic_duct) p.x *= 0.1;
  borders.main_ducts = borders.hepatic_duct;
  const TriangleWindow window(borders, MakeLump({0.001, 0.004, 0}, 5), kSettings);
  EXPECT_GT(window.Area(), 20e-6);
  EXPECT_LT(window.CalcOpenShare(std::vector<std::uint8_t>(5, 1)), 0.8);
}

TEST(TriangleWindow, IsNoneWithoutDucts) {
  const TriangleWindow window({}, MakeLump({}, 3), kSettings);
  EXPECT_EQ(window.Area(), 0.0);
  EXPECT_TRUE(window.Strands().empty());
  EXPECT_EQ(window.CalcOpenShare(std::vector<std::uint8_t>{1, 1, 1}), 1.0);
}

}  // namespace
}  // namespace trocar::training
