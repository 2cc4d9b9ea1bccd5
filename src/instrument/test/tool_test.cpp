// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::instrument {
namespace {

TEST(FindTool, KnowsTheGrasperAndNothingElseYet) {
  ASSERT_NE(FindTool("grasper"), nullptr);
  EXPECT_EQ(FindTool("spoon"), nullptr);
}

TEST(JawTip, OpensSymmetricallyAndClosesAtTheOrigin) {
  const Tool tool;
  EXPECT_NEAR(math::Norm(JawTip(tool, 0.0, +1)), 0.0, 1e-15);
  const Vec3 upper = JawTip(tool, 0.5, +1), lower = JawTip(tool, 0.5, -1);
  EXPECT_GT(upper.y, 0.0);
  EXPECT_NEAR(upper.y, -lower.y, 1e-15);
  EXPECT_NEAR(math::Distance(upper, JawHinge(tool)), tool.jaw_length, 1e-15);
}

TEST(CalcPartPose, TurnsTheDrawnJawOntoItsTip) {
  const Tool tool;
  for (const double jaw : {0.0, 0.4, 1.0}) {
    EXPECT_NEAR(
        math::Distance(CalcPartPose(tool, ToolPart::Kind::kUpperJaw, jaw) * Vec3{}, JawTip(tool, jaw, +1)),
        0.0, 1e-15);
    EXPECT_NEAR(
        math::Distance(CalcPartPose(tool, ToolPart::Kind::kLowerJaw, jaw) * Vec3{}, JawTip(tool, jaw, -1)),
        0.0, 1e-15);
  }
}

TEST(MakeParts, AreClosedAndOutward) {
  for (const ToolPart& part : MakeParts(Tool{})) {
    const geometry::MeshReport report = geometry::InspectMesh(part.mesh);
    EXPECT_TRUE(report.closed && report.manifold && report.outward) << static_cast<int>(part.kind);
  }
}

TEST(CalcCapsules, ReachesNoFartherThanTheShaft) {
  const Tool tool;
  EXPECT_NEAR(CalcCapsules(tool, 0.0, 5.0).shaft.b.z, tool.shaft_length, 1e-15);
  EXPECT_NEAR(CalcCapsules(tool, 0.0, 0.05).shaft.b.z, tool.jaw_length + 0.05, 1e-15);
}

}  // namespace
}  // namespace trocar::instrument
