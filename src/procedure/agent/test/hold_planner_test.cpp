// SPDX-License-Identifier: Apache-2.0
// Where a grasper takes a made-up organ: a sheet of wall whose front faces the trocar, with another organ beside it.
#include "hold_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr std::uint32_t kSide = 9;

/// 9 x 9 nodes, 8 mm apart, from the origin along x and y; the trocar is 15 cm above.
struct Wall {
  scene::SurfaceInfo organ;
  std::vector<Vec3> positions;
  HoldField field;

  explicit Wall(bool faces_port = true) {
    organ.node_count = kSide * kSide;
    for (std::uint32_t row = 0; row < kSide; ++row) {
      for (std::uint32_t column = 0; column < kSide; ++column)
        positions.push_back({0.008 * column, 0.008 * row, 0});
    }
    for (std::uint32_t row = 0; row + 1 < kSide; ++row) {
      for (std::uint32_t column = 0; column + 1 < kSide; ++column) {
        const std::uint32_t a = row * kSide + column, b = a + 1, c = a + kSide, d = c + 1;
        organ.triangles.push_back(faces_port ? geometry::Triangle{a, b, d} : geometry::Triangle{a, d, b});
        organ.triangles.push_back(faces_port ? geometry::Triangle{a, d, c} : geometry::Triangle{a, c, d});
      }
    }
    field.organ = &organ;
    field.positions = positions;
    field.port = {0.032, 0.032, 0.15};
    field.jaw_length = 0.02;
    field.spared_clearance = [](const collision::Segment&, double most) { return most; };
    field.clearance = [](const collision::Segment&) { return 0.03; };
    field.may = [](std::uint32_t) { return true; };
  }
};

const Vec3 kWork{0.032, 0.032, 0};

TEST(FindHold, TakesWallBesideTheWorkNotAtIt) {
  const Wall wall;
  const auto node = FindHold(wall.field, kWork, {});
  ASSERT_TRUE(node);
  const double away = math::Distance(wall.positions[*node], kWork);
  EXPECT_NEAR(away, 0.020, 0.005);
}

TEST(FindHold, TakesNothingThatFacesAwayOrMayNotBeHeld) {
  EXPECT_FALSE(FindHold(Wall(false).field, kWork, {}));
  Wall wall;
  wall.field.may = [](std::uint32_t) { return false; };
  EXPECT_FALSE(FindHold(wall.field, kWork, {}));
  wall.field.may = [](std::uint32_t node) { return node == 3; };
  EXPECT_EQ(FindHold(wall.field, kWork, {}), 3u);
}

TEST(FindHold, GoesElsewhereAfterAMiss) {
  const Wall wall;
  std::vector<std::uint32_t> missed;
  for (int round = 0; round < 4; ++round) {
    const auto node = FindHold(wall.field, kWork, missed);
    ASSERT_TRUE(node);
    for (const std::uint32_t other : missed)
      EXPECT_GT(math::Distance(wall.positions[*node], wall.positions[other]), 0.004);
    missed.push_back(*node);
  }
}

TEST(FindHold, KeepsTheJawsOffTheOrganThatIsSpared) {
  Wall wall;
  // a wall along x = 30 mm, on the side of small x
  wall.field.spared_clearance = [](const collision::Segment& jaws, double most) {
    return std::clamp(std::min(jaws.start.x, jaws.end.x) - 0.030, 0.0, most);
  };
  const auto node = FindHold(wall.field, kWork, {});
  ASSERT_TRUE(node);
  EXPECT_GT(wall.positions[*node].x, 0.036);
  // and mirrored
  wall.field.spared_clearance = [](const collision::Segment& jaws, double most) {
    return std::clamp(0.034 - std::max(jaws.start.x, jaws.end.x), 0.0, most);
  };
  const auto other = FindHold(wall.field, kWork, {});
  ASSERT_TRUE(other);
  EXPECT_LT(wall.positions[*other].x, 0.028);
}

TEST(HoldFilter, KeepsToItsPartOfTheOrgan) {
  constexpr double kLength = 0.080;
  const auto allows = [](HoldFilter::Kind kind, double peels, double along) {
    return HoldFilter{kind, peels}.Allows(along, kLength);
  };
  using Kind = HoldFilter::Kind;
  for (const double along : {0.001, 0.040, 0.079}) EXPECT_TRUE(allows(Kind::kAny, 0, along));
  EXPECT_TRUE(allows(Kind::kNeck, 0, 0.005));
  EXPECT_FALSE(allows(Kind::kNeck, 0, 0.020));
  // the flap before the place where it peels off, neither at its edge nor far down
  EXPECT_TRUE(allows(Kind::kFree, 0.050, 0.030));
  EXPECT_FALSE(allows(Kind::kFree, 0.050, 0.045));
  EXPECT_FALSE(allows(Kind::kFree, 0.050, 0.060));
  EXPECT_FALSE(allows(Kind::kFree, 0.050, 0.005));
  // the fundus itself, or the flap beyond
  EXPECT_TRUE(allows(Kind::kFundus, 0.010, 0.075));
  EXPECT_TRUE(allows(Kind::kFundus, 0.010, 0.030));
  EXPECT_FALSE(allows(Kind::kFundus, 0.010, 0.015));
}

}  // namespace
}  // namespace trocar::agent
