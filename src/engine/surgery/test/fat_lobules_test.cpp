// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/fat_lobules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "trocar/math/random.h"

namespace trocar::surgery {
namespace {

using math::Vec3;

constexpr double kRadius = 0.002;  // m

/// Strands of 4 mm along z, `per_column` one after another in each of some columns along x.
struct Lump {
  std::vector<FatStrand> strands;
  std::vector<Vec3> rest;

  Lump(std::size_t columns, std::size_t per_column, double spacing) {
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t k = 0; k <= per_column; ++k) {
        const auto node = static_cast<std::uint32_t>(rest.size());
        rest.push_back({spacing * static_cast<double>(c), 0, 0.004 * static_cast<double>(k)});
        if (k > 0) strands.push_back({static_cast<std::uint32_t>(strands.size()), node - 1, node});
      }
    }
  }
};

TEST(FatLobules, AreFullWhereAllIsWhole) {
  const Lump lump(3, 2, 0.003);
  const FatLobules fat(lump.strands, lump.rest, kRadius);
  ASSERT_EQ(fat.Count(), 2 * lump.strands.size());
  for (std::size_t i = 0; i < fat.Count(); ++i) {
    EXPECT_TRUE(fat.IsThere(i));
    EXPECT_GE(fat.Radius(i), 0.7 * kRadius);
    EXPECT_LE(fat.Radius(i), 1.3 * kRadius);
    EXPECT_EQ(fat.Centre(i, lump.rest), fat.Rest(i));
  }
}

TEST(FatLobules, ShrinkWithTheStrandsThatAreLeftAndGoWithTheirOwn) {
  const Lump lump(1, 3, 0.003);
  FatLobules fat(lump.strands, lump.rest, kRadius);
  const double whole = fat.Radius(0);
  const std::vector<std::uint8_t> intact = {1, 0, 1};
  fat.Update(intact);
  EXPECT_FALSE(fat.IsThere(2));
  EXPECT_FALSE(fat.IsThere(3));
  EXPECT_TRUE(fat.IsThere(0));
  // half of what met at its upper end is left, and less than nine tenths of its body
  EXPECT_LT(fat.Radius(0), std::cbrt(0.5) * whole);
  EXPECT_GT(fat.Radius(0), 0.25 * std::cbrt(0.5) * whole);
  fat.Update({});
  EXPECT_EQ(fat.Radius(0), whole) << "strands that nobody speaks of are whole";
}

// What is counted on from tick to tick is what it would be from the start.
TEST(FatLobules, DoNotDependOnTheWay) {
  const Lump lump(9, 8, 0.002);
  FatLobules fat(lump.strands, lump.rest, kRadius);
  std::vector<std::uint8_t> intact(lump.strands.size(), 1);
  math::Random random(3);
  for (int round = 0; round < 20; ++round) {
    for (std::uint8_t& flag : intact) flag = random.Uniform() < 0.2 ? !flag : flag;
    fat.Update(intact);
  }
  FatLobules fresh(lump.strands, lump.rest, kRadius);
  fresh.Update(intact);
  for (std::size_t i = 0; i < fat.Count(); ++i) {
    EXPECT_EQ(fat.Radius(i), fresh.Radius(i));
    EXPECT_EQ(fat.Centre(i, lump.rest), fresh.Centre(i, lump.rest));
  }
}

TEST(FatLobules, HideWhatLiesBehindThemAsFarAsTheyReach) {
  const Lump lump(1, 1, 0.003);
  FatLobules fat(lump.strands, lump.rest, kRadius);
  const Vec3 centre = fat.Centre(0, lump.rest);
  const double radius = fat.Radius(0);
  const auto past = [&](double beside) {
    const Vec3 at = centre + Vec3{-beside, 0, 0};
    return collision::Segment{at + Vec3{0, 0.05, 0}, at - Vec3{0, 0.05, 0}};
  };
  EXPECT_TRUE(fat.Hide(lump.rest, past(0)));
  EXPECT_TRUE(fat.Hide(lump.rest, past(0.99 * radius)));
  EXPECT_FALSE(fat.Hide(lump.rest, past(0.02)));
  // sight ends before it, or begins behind it
  EXPECT_FALSE(fat.Hide(lump.rest, {centre + Vec3{0, 0.05, 0}, centre + Vec3{0, 0.01, 0}}));
  // it goes where its nodes go
  std::vector<Vec3> moved = lump.rest;
  for (Vec3& p : moved) p += Vec3{0.03, 0, 0};
  EXPECT_FALSE(fat.Hide(moved, past(0)));
  EXPECT_TRUE(fat.Hide(moved, past(-0.03)));
  const std::vector<std::uint8_t> divided = {0};
  fat.Update(divided);
  EXPECT_FALSE(fat.Hide(moved, past(-0.03)));
}

}  // namespace
}  // namespace trocar::surgery
