// SPDX-License-Identifier: Apache-2.0
// Where a dissector opens: among many fibres rather than at one, and not into a duct; and where scissors take a single one.
#include "spread_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {

using math::Vec3;

namespace {

/// Upright fibres, 2 mm apart, along a line; the port lies 15 cm along y.
SpreadField FieldWithRow(int count) {
  SpreadField field;
  for (int i = 0; i < count; ++i) {
    const double x = 0.002 * i;
    field.fibres.push_back({{x, 0, -0.002}, {x, 0, 0.002}});
    field.weights.push_back(1.0);
  }
  field.port = {0.01, 0.15, 0};
  field.tip = {0.01, 0.03, 0};
  field.tool = instrument::FindTool("maryland");
  field.clearance = [](const collision::Segment&) { return 0.05; };
  return field;
}

/// Fibres that cross the plane of the opened jaws between where they stand before and after.
int CountParted(const SpreadField& field, const SpreadPose& pose) {
  const math::Pose X = math::Inverse(
      instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0)));
  int count = 0;
  for (const auto& fibre : field.fibres) {
    constexpr int kParts = 400;
    bool crosses = false;
    for (int i = 0; i < kParts && !crosses; ++i) {
      const Vec3 a = X * math::Lerp(fibre.start, fibre.end, i / double{kParts});
      const Vec3 b = X * math::Lerp(fibre.start, fibre.end, (i + 1) / double{kParts});
      if (a.x * b.x > 0.0) continue;
      const double along = field.tool->jaw_length - a.z, angle = std::atan2(std::fabs(a.y), along);
      crosses = along > 0 && std::hypot(along, a.y) <= field.tool->jaw_length &&
                angle > kNarrow * 0.5 * field.tool->max_jaw && angle < 0.5 * field.tool->max_jaw;
    }
    count += crosses ? 1 : 0;
  }
  return count;
}

TEST(SpreadPlan, OpensAcrossARowOfFibres) {
  const SpreadField field = FieldWithRow(9);
  const std::vector<std::uint8_t> tries(9, 0);
  const auto pose = FindSpread(field, tries);
  ASSERT_TRUE(pose);
  const int parted = CountParted(field, *pose);
  EXPECT_GE(parted, 4);
  EXPECT_NEAR(pose->worth, parted, 1.0);
}

TEST(SpreadPlan, KeepsOffADuct) {
  SpreadField field = FieldWithRow(9);
  // a duct through the left half of the row
  for (int i = -10; i <= 10; ++i) field.tubes.push_back({{0.004, 0, 0.002 * i}, 0.0015});
  const std::vector<std::uint8_t> tries(9, 0);
  const auto pose = FindSpread(field, tries);
  ASSERT_TRUE(pose);
  const math::Pose X = math::Inverse(
      instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose->tip, pose->spin, 0.0)));
  for (const auto& tube : field.tubes) {
    const Vec3 p = X * tube.p;
    const double along = field.tool->jaw_length - p.z, angle = std::atan2(std::fabs(p.y), along);
    const bool is_swept = std::fabs(p.x) < tube.radius && along > 0 &&
                          std::hypot(along, p.y) < field.tool->jaw_length &&
                          angle < 0.5 * field.tool->max_jaw;
    EXPECT_FALSE(is_swept);
  }
}

TEST(SpreadPlan, GivesUpWhereNothingIsLeftOrEverythingWasTried) {
  SpreadField field = FieldWithRow(5);
  EXPECT_FALSE(FindSpread(field, std::vector<std::uint8_t>(5, 3)));
  field.clearance = [](const collision::Segment&) { return -0.05; };
  EXPECT_FALSE(FindSpread(field, std::vector<std::uint8_t>(5, 0))) << "no room beside an organ";
  field.fibres.clear();
  field.weights.clear();
  EXPECT_FALSE(FindSpread(field, {}));
}

/// A fibre of 3 mm in the corner between two ducts that meet before it, as seen from the port.
SpreadField FieldInACorner(double gap) {
  SpreadField field = FieldWithRow(0);
  field.tool = instrument::FindTool("scissors");
  field.fibres.push_back({{0.01, 0, -0.0015}, {0.01, 0, 0.0015}});
  field.weights.push_back(1.0);
  constexpr double kRadius = 0.0015;
  for (int i = 0; i <= 40; ++i) {
    const double along = 0.0005 * i;
    // one to each side, and away from the port
    field.tubes.push_back({{0.01 - gap - kRadius - 0.3 * along, -along, 0}, kRadius});
    field.tubes.push_back({{0.01 + gap + kRadius + 0.3 * along, -along, 0}, kRadius});
  }
  return field;
}

/// By looking at many points between the blades: how far they are from a duct's skin.
double LeastRoom(const SpreadField& field, const SpreadPose& pose) {
  const instrument::Tool& tool = *field.tool;
  const math::Pose X =
      instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0));
  double least = 1.0;
  for (int k = 0; k <= 100; ++k) {
    for (int side = -20; side <= 20; ++side) {
      const double angle = 0.5 * tool.max_jaw * pose.opening * side / 20.0,
                   away = tool.jaw_length * k / 100.0;
      const Vec3 p = X * Vec3{0, away * std::sin(angle), tool.jaw_length - away * std::cos(angle)};
      for (const auto& tube : field.tubes) least = std::min(least, math::Distance(p, tube.p) - tube.radius);
    }
  }
  return least;
}

TEST(SnipPlan, TakesAFibreThatJawsCannotPart) {
  const SpreadField field = FieldInACorner(0.0012);
  const std::vector<std::uint8_t> tries(1, 0);
  SpreadField blunt = field;
  blunt.tool = instrument::FindTool("maryland");
  EXPECT_FALSE(FindSpread(blunt, tries)) << "the scene is one for scissors";
  const auto pose = FindSnip(field, tries);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->aim, 0u);
  const double room = LeastRoom(field, *pose);
  EXPECT_GE(room, 0.0004);
  EXPECT_NEAR(pose->worth, std::min(room, 0.002), 0.0002);
}

TEST(SnipPlan, LeavesAFibreThatADuctTouches) {
  EXPECT_FALSE(FindSnip(FieldInACorner(0.0002), std::vector<std::uint8_t>(1, 0)));
  SpreadField field = FieldInACorner(0.0012);
  EXPECT_FALSE(FindSnip(field, std::vector<std::uint8_t>(1, 3))) << "it was tried often enough";
  field.clearance = [](const collision::Segment&) { return 0.0003; };
  EXPECT_FALSE(FindSnip(field, std::vector<std::uint8_t>(1, 0))) << "no room beside an organ";
}

// blades that were pushed aside on their way
TEST(SnipPlan, BladesBesideTheFibreOrOnADuctDoNotClose) {
  const SpreadField field = FieldInACorner(0.0012);
  const auto pose = FindSnip(field, std::vector<std::uint8_t>(1, 0));
  ASSERT_TRUE(pose);
  const auto stand = [&](const Vec3& tip) {
    return instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, tip, pose->spin, 0.0));
  };
  EXPECT_TRUE(FindSnipRoom(field, 0, stand(pose->tip), pose->opening));
  const Vec3 back = math::Normalized(field.port - pose->tip);
  EXPECT_FALSE(FindSnipRoom(field, 0, stand(pose->tip + 0.003 * back), pose->opening)) << "before the fibre";
  SpreadField crossed = field;
  crossed.tubes.push_back({pose->tip + 0.004 * back, 0.0005});
  EXPECT_FALSE(FindSnipRoom(crossed, 0, stand(pose->tip), pose->opening)) << "an artery between the blades";
}

}  // namespace
}  // namespace trocar::agent
