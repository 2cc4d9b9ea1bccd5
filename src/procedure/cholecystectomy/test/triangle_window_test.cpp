// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triangle_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace trocar::cholecystectomy {

using math::Vec3;
namespace {

constexpr TriangleWindowSettings kSettings{0.005, 0.003, 0.002};

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

/// Share of the window's fat that is gone when a second lump is all that is left of two.
double ClearedBut(const std::vector<TriangleFat>& left) {
  std::vector<TriangleFat> fat = MakeLump({0.015, 0.004, 0}, 20);
  const std::size_t gone = fat.size();
  for (TriangleFat strand : left) {
    strand.strand += static_cast<std::uint32_t>(gone);
    fat.push_back(strand);
  }
  const TriangleWindow window(MakeBorders(), fat, kSettings);
  std::vector<std::uint8_t> is_intact(fat.size(), 1);
  std::fill(is_intact.begin(), is_intact.begin() + static_cast<std::ptrdiff_t>(gone), std::uint8_t{0});
  return window.CalcClearedShare(is_intact);
}

TEST(TriangleWindow, IsTheTriangleLessTheBorderBesideTheMainDuct) {
  const TriangleWindow window(MakeBorders(), {}, kSettings);
  // what is left is a triangle of 25 mm by 16.7 mm
  EXPECT_NEAR(window.Area(), 0.5 * 0.025 * 0.025 * 20 / 30, 15e-6);
  EXPECT_EQ(window.CalcClearedShare({}), 1.0);
}

TEST(TriangleWindow, ALumpOverTheTriangleNearTheMainDuctCounts) {
  // 7 mm beside the hepatic duct, where fat within 10 mm was once left out
  EXPECT_NEAR(ClearedBut(MakeLump({0.007, 0.006, 0}, 20)), 0.5, 0.2);
}

TEST(TriangleWindow, WhatLiesBeforeOrBehindCoversAlike) {
  const double cleared = ClearedBut(MakeLump({0.010, 0.004, 0}, 10));
  EXPECT_LT(cleared, 0.8);
  EXPECT_EQ(ClearedBut(MakeLump({0.010, 0.004, 0.008}, 10)), cleared);
  EXPECT_EQ(ClearedBut(MakeLump({0.010, 0.004, -0.008}, 10)), cleared);
}

TEST(TriangleWindow, FatOnAndBeyondTheMainDuctAndBelowTheCysticDuctMayStay) {
  EXPECT_EQ(ClearedBut(MakeLump({0, 0.010, 0}, 20)), 1.0);
  EXPECT_EQ(ClearedBut(MakeLump({-0.010, 0.010, 0}, 20)), 1.0);
  EXPECT_EQ(ClearedBut(MakeLump({0.015, -0.006, 0}, 20)), 1.0);
}

// A lump before the artery hides the window, the sheath on it does not.
TEST(TriangleWindow, TheSheathOfAMainArteryMayStayButNotWhatLiesBeforeIt) {
  TriangleBorders borders = MakeBorders();
  for (int i = 0; i <= 10; ++i) borders.main_arteries.push_back({0.006 + 0.0015 * i, 0.006, 0});
  const std::vector<TriangleFat> fat = {{0, {Vec3{0.012, 0.0065, 0.001}, Vec3{0.012, 0.0075, 0.002}}},
                                        {1, {Vec3{0.012, 0.006, 0.004}, Vec3{0.012, 0.006, 0.006}}}};
  const TriangleWindow window(borders, fat, kSettings);
  EXPECT_EQ(window.Strands(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(window.CalcClearedShare(std::vector<std::uint8_t>{1, 1}), 0.0);
  EXPECT_EQ(window.CalcClearedShare(std::vector<std::uint8_t>{1, 0}), 1.0);
}

// Its middle is beyond the cystic duct or on the border beside the hepatic duct; the window begins 5 mm from that.
TEST(TriangleWindow, ALobuleAtTheFringeCountsWhenItReachesOver) {
  const auto strand_at = [](std::uint32_t strand, const Vec3& p) {
    return TriangleFat{strand, {p - Vec3{0, 0, 0.0005}, p + Vec3{0, 0, 0.0005}}};
  };
  const std::vector<TriangleFat> fat = {strand_at(0, {0.015, -0.001, 0}), strand_at(1, {0.015, -0.003, 0}),
                                        strand_at(2, {0.0041, 0.006, 0}), strand_at(3, {0.002, 0.006, 0})};
  EXPECT_EQ(TriangleWindow(MakeBorders(), fat, kSettings).Strands(), (std::vector<std::uint32_t>{0, 2}));
}

TEST(TriangleWindow, ATriangleNarrowerThanTheBorderIsAllWindow) {
  TriangleBorders borders = MakeBorders();
  for (Vec3& p : borders.cystic_duct) p.x *= 0.1;
  borders.main_ducts = borders.hepatic_duct;
  const TriangleWindow window(borders, MakeLump({0.001, 0.004, 0}, 5), kSettings);
  EXPECT_GT(window.Area(), 20e-6);
  EXPECT_EQ(window.CalcClearedShare(std::vector<std::uint8_t>(5, 1)), 0.0);
  EXPECT_EQ(window.Strands().size(), 5u);
}

TEST(TriangleWindow, IsNoneWithoutDucts) {
  const TriangleWindow window({}, MakeLump({}, 3), kSettings);
  EXPECT_EQ(window.Area(), 0.0);
  EXPECT_TRUE(window.Strands().empty());
  EXPECT_EQ(window.CalcClearedShare(std::vector<std::uint8_t>{1, 1, 1}), 1.0);
}

}  // namespace
}  // namespace trocar::cholecystectomy
