// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::instrument {
namespace {

TEST(FindTool, KnowsEveryToolByItsName) {
  for (const char* name :
       {"grasper", "maryland", "hook", "scissors", "clip_applier", "suction_irrigator", "bag"}) {
    const Tool* tool = FindTool(name);
    ASSERT_NE(tool, nullptr) << name;
    EXPECT_EQ(tool->name, name);
    EXPECT_EQ(tool->shaft_length, 0.33) << name;
  }
  EXPECT_EQ(FindTool("spoon"), nullptr);
  EXPECT_EQ(FindTool("clip_applier")->shaft_radius, 0.005) << "10 mm";
  EXPECT_GT(FindTool("clip_applier")->clips, 0);
  EXPECT_EQ(FindTool("hook")->max_jaw, 0.0);
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
