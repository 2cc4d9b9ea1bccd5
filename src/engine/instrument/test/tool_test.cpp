// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::instrument {

using math::Vec3;

namespace {

constexpr const char* kNames[] = {"grasper",      "maryland",          "hook", "scissors",
                                  "clip_applier", "suction_irrigator", "bag",  "linear_stapler"};

TEST(AllTools, StandInTheOrderOfTheirKinds) {
  ASSERT_EQ(AllTools().size(), kToolKindCount);
  for (std::size_t i = 0; i < AllTools().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(AllTools()[i].kind), i) << AllTools()[i].name;
}

// Each ability is of some tools and not of all; what bites, takes or spreads needs jaws, what holds clips has a stock.
TEST(AbilitiesOf, FitTheShapesOfTheTools) {
  for (const Tool& tool : AllTools()) {
    const ToolAbilities& can = AbilitiesOf(tool.kind);
    const bool needs_jaws = can.takes || can.spreads || can.bites || can.electrode == Electrode::kJaws ||
                            can.blade == Blade::kJaws;
    EXPECT_EQ(needs_jaws, tool.max_jaw > 0.0) << tool.name;
    EXPECT_EQ(can.holds_clips || can.staples, tool.clips > 0) << tool.name;
  }
  for (const Tool& tool : AllTools()) {
    const ToolAbilities& can = AbilitiesOf(tool.kind);
    EXPECT_EQ(can.pedals.coagulate, can.electrode != Electrode::kNone) << tool.name;
    EXPECT_EQ(can.pedals.rinse, can.sucks) << tool.name;
  }
  const ToolAbilities& hook = AbilitiesOf(ToolKind::kHook);
  EXPECT_TRUE(hook.electrode == Electrode::kToe && hook.blade == Blade::kHeel);
  EXPECT_TRUE(AbilitiesOf(ToolKind::kDissector).spreads && !AbilitiesOf(ToolKind::kGrasper).spreads);
  EXPECT_TRUE(AbilitiesOf(ToolKind::kScissors).bites && AbilitiesOf(ToolKind::kClipApplier).bites);
  EXPECT_TRUE(AbilitiesOf(ToolKind::kSuctionIrrigator).sucks && AbilitiesOf(ToolKind::kBag).is_bag);
}

TEST(FindTool, KnowsEveryToolByItsName) {
  for (const char* name : kNames) {
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

const ToolPart* FindPart(const std::vector<ToolPart>& parts, ToolPart::Kind kind) {
  for (const ToolPart& part : parts)
    if (part.kind == kind) return &part;
  return nullptr;
}

TEST(MakeParts, AreClosedAndOutward) {
  for (const char* name : kNames) {
    for (const ToolPart& part : MakeParts(*FindTool(name))) {
      const geometry::MeshReport report = geometry::InspectMesh(part.mesh);
      EXPECT_TRUE(report.closed && report.manifold && report.outward)
          << name << " part " << static_cast<int>(part.kind) << ": boundary " << report.boundary_edges
          << ", odd edges " << report.odd_edges << ", odd vertices " << report.odd_vertices << ", degenerate "
          << report.degenerate;
    }
  }
}

TEST(MakeParts, ShaftsHaveTheirTrueThicknessAndLength) {
  for (const char* name : kNames) {
    const Tool& tool = *FindTool(name);
    const std::vector<ToolPart> parts = MakeParts(tool);
    ASSERT_EQ(parts[0].kind, ToolPart::Kind::kShaft) << name;
    const geometry::Box box = geometry::CalcBox(parts[0].mesh.positions);
    EXPECT_NEAR(box.max.y, tool.shaft_radius, 1e-9) << name;
    EXPECT_NEAR(box.max.z, tool.shaft_length, 1e-9) << name;
  }
}

TEST(MakeParts, JawsReachTheirTipsAndNoFarther) {
  for (const char* name : {"grasper", "maryland", "scissors", "clip_applier"}) {
    const Tool& tool = *FindTool(name);
    const std::vector<ToolPart> parts = MakeParts(tool);
    for (const int side : {-1, +1}) {
      const auto kind = side > 0 ? ToolPart::Kind::kUpperJaw : ToolPart::Kind::kLowerJaw;
      const ToolPart* jaw = FindPart(parts, kind);
      ASSERT_NE(jaw, nullptr) << name;
      for (const double opening : {0.0, 0.6 * tool.max_jaw, tool.max_jaw}) {
        const math::Pose X_tool_jaw = CalcPartPose(tool, kind, opening);
        const Vec3 tip = JawTip(tool, opening, side), along = math::Normalized(tip - JawHinge(tool));
        double nearest = 1, beyond = -1;
        for (const Vec3& p : jaw->mesh.positions) {
          const Vec3 from_tip = X_tool_jaw * p - tip;
          nearest = std::min(nearest, math::Norm(from_tip));
          beyond = std::max(beyond, math::Dot(from_tip, along));
        }
        EXPECT_LT(nearest, 0.0008) << name << " " << side << " " << opening;
        EXPECT_NEAR(beyond, 0.0, 1e-6) << name << " " << side << " " << opening;
      }
      const geometry::Box box = geometry::CalcBox(jaw->mesh.positions);
      EXPECT_LE(box.max.x - box.min.x, 1.01 * tool.jaw_width + 0.001) << name;
      EXPECT_NEAR(box.max.z, tool.jaw_length, 1e-9) << name;
    }
  }
}

TEST(MakeParts, ClosedJawsMeetWithoutPassingThroughEachOther) {
  for (const char* name : {"grasper", "clip_applier"}) {
    const std::vector<ToolPart> parts = MakeParts(*FindTool(name));
    EXPECT_GE(geometry::CalcBox(FindPart(parts, ToolPart::Kind::kUpperJaw)->mesh.positions).min.y, 0.0)
        << name;
    EXPECT_LE(geometry::CalcBox(FindPart(parts, ToolPart::Kind::kLowerJaw)->mesh.positions).max.y, 0.0)
        << name;
  }
}

TEST(MakeParts, TheHooksToePointsAlongYAndIsFourAndAHalfMillimetresLong) {
  const std::vector<ToolPart> parts = MakeParts(*FindTool("hook"));
  const geometry::Box box = geometry::CalcBox(FindPart(parts, ToolPart::Kind::kTip)->mesh.positions);
  EXPECT_NEAR(box.max.y, 0.0045, 1e-4);
  EXPECT_GT(box.min.y, -0.0007);
  EXPECT_GT(box.min.z, -0.0007);
  // bare from the insulation on
  EXPECT_GE(geometry::CalcBox(parts[0].mesh.positions).min.z, FindTool("hook")->jaw_length);
}

TEST(MakeParts, TheSuctionTubeHasSideHolesIntoItsBore) {
  const geometry::MeshReport report =
      geometry::InspectMesh(MakeParts(*FindTool("suction_irrigator"))[0].mesh);
  EXPECT_EQ(report.components, 1u);
  EXPECT_EQ(report.genus, 12) << "three rows of four holes";
}

TEST(MakeParts, OnlyTheClipApplierHoldsAClip) {
  for (const char* name : kNames) {
    const bool has_clip = FindPart(MakeParts(*FindTool(name)), ToolPart::Kind::kUpperClip) != nullptr;
    EXPECT_EQ(has_clip, AbilitiesOf(FindTool(name)->kind).holds_clips) << name;
  }
  const std::vector<ToolPart> parts = MakeParts(*FindTool("clip_applier"));
  const geometry::Box leg = geometry::CalcBox(FindPart(parts, ToolPart::Kind::kUpperClip)->mesh.positions);
  EXPECT_NEAR(leg.max.z - leg.min.z, 0.009, 0.001) << "a clip is 9 mm long";
  EXPECT_NEAR(2 * JawTip(*FindTool("clip_applier"), 0.5, +1).y, 0.006, 1e-4) << "and opens 6 mm";
}

TEST(MakeParts, TheBagsMouthLiesAheadOfTheTip) {
  const std::vector<ToolPart> parts = MakeParts(*FindTool("bag"));
  const geometry::Box ring = geometry::CalcBox(FindPart(parts, ToolPart::Kind::kTip)->mesh.positions);
  EXPECT_NEAR(ring.max.x - ring.min.x, kBagMouth, 1e-9);
  EXPECT_NEAR(ring.min.z, -kBagMouth, 1e-9);
  const geometry::Box pouch = geometry::CalcBox(FindPart(parts, ToolPart::Kind::kPouch)->mesh.positions);
  EXPECT_NEAR(pouch.min.y, -kBagDepth, 1e-9);
  EXPECT_NEAR(pouch.max.y, 0.0, 1e-9);
}

TEST(CalcCapsules, AToolWithoutJawsHasOneTip) {
  for (const char* name : {"hook", "suction_irrigator", "bag"}) {
    const Tool& tool = *FindTool(name);
    const ToolCapsules capsules = CalcCapsules(tool, 0.9, 0.1);
    EXPECT_EQ(capsules.upper_jaw.a, capsules.lower_jaw.a) << name;
    EXPECT_EQ(capsules.upper_jaw.b, capsules.lower_jaw.b) << name;
    EXPECT_NEAR(math::Norm(capsules.upper_jaw.a), 0.0, 1e-15) << name;
    EXPECT_EQ(CalcPartPose(tool, ToolPart::Kind::kTip, 0.9), math::Pose{}) << name;
  }
}

TEST(CalcCapsules, ReachesNoFartherThanTheShaft) {
  const Tool tool;
  EXPECT_NEAR(CalcCapsules(tool, 0.0, 5.0).shaft.b.z, tool.shaft_length, 1e-15);
  EXPECT_NEAR(CalcCapsules(tool, 0.0, 0.05).shaft.b.z, tool.jaw_length + 0.05, 1e-15);
}

}  // namespace
}  // namespace trocar::instrument
