// SPDX-License-Identifier: Apache-2.0
// Where a dissector opens: among many fibres rather than at one, and not into a duct.
#include "spread_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {
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

}  // namespace
}  // namespace trocar::agent
