// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/operation_guide.h"
#include "trocar/cholecystectomy/cholecystectomy.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/presenter/key_bindings.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::presenter {
namespace {

using assessment::Milestone;
using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;

/// An operation as plain values.
struct Table {
  scene::Scene scene;
  simulation::Snapshot now;
  std::vector<scene::StrandInfo> strands;
  Milestone reached = Milestone::kStart;

  Table() {
    for (const ToolKind kind :
         {ToolKind::kGrasper, ToolKind::kHook, ToolKind::kClipApplier, ToolKind::kScissors, ToolKind::kBag}) {
      instrument::Tool tool;
      tool.kind = kind;
      scene.instruments[kRight].tray.push_back(tool);
    }
    now.positions = {{0, 0, 0}, {0.002, 0, 0}, {0.05, 0, 0}, {0.052, 0, 0}, {0, 0.09, 0}, {0, 0.092, 0}};
    strands = {{0, 1, roles::StrandRole::kTriangle, -1},
               {2, 3, roles::StrandRole::kTriangle, -1},
               {4, 5, roles::StrandRole::kBed, -1}};
    now.operation.strand_is_intact = {1, 1, 1};
    now.operation.assistant.is_there = true;
    scene::SizeSnapshot(cholecystectomy::Cholecystectomy(), now.operation.procedure);
    now.operation.procedure.measures[cholecystectomy::kStructuresEntering] = 2;
  }
  void Take(ToolKind kind) {
    for (std::size_t i = 0; i < scene.instruments[kRight].tray.size(); ++i) {
      if (scene.instruments[kRight].tray[i].kind == kind)
        now.operation.tools[kRight] = static_cast<std::uint8_t>(i);
    }
  }
  OperationStep Next() const { return FindOperationStep(scene, strands, now, reached); }
  bool Says(const char* words) const { return std::string(Next().text).find(words) != std::string::npos; }
};

TEST(OperationGuide, LeadsFromTheFirstLookToTheBag) {
  Table table;
  EXPECT_TRUE(table.Says("assistant takes the fundus"));
  table.now.operation.assistant.is_holding = true;
  EXPECT_TRUE(table.Says("neck"));
  table.now.instruments[kLeft].is_grasping = true;
  EXPECT_TRUE(table.Says("the hook"));
  table.Take(ToolKind::kHook);
  EXPECT_TRUE(table.Says("fibre of the triangle"));
  table.now.operation.procedure.view.criteria = {2, 0, 0};
  EXPECT_TRUE(table.Says("lowest third"));
  table.now.operation.procedure.view.criteria = {2, 2, 0};
  EXPECT_TRUE(table.Says("all round"));
  table.now.operation.procedure.view.criteria = {2, 2, 2};
  EXPECT_TRUE(table.Says("Show the front"));
  table.now.operation.procedure.view.sights[cholecystectomy::kFromFront] = 1;
  EXPECT_TRUE(table.Says("Show the back"));
  table.reached = Milestone::kCriticalView;
  EXPECT_TRUE(table.Says("the clip applier"));
  table.Take(ToolKind::kClipApplier);
  EXPECT_TRUE(table.Says("Clip duct and artery"));
  table.now.operation.clip_count = 6;
  EXPECT_TRUE(table.Says("the scissors"));
  table.Take(ToolKind::kScissors);
  EXPECT_TRUE(table.Says("Cut duct and artery"));
  table.now.operation.procedure.measures[cholecystectomy::kStructuresEntering] = 0;
  table.reached = Milestone::kDivided;
  EXPECT_TRUE(table.Says("the hook"));
  table.Take(ToolKind::kHook);
  EXPECT_TRUE(table.Says("off its bed"));
  table.now.operation.is_organ_free = true;
  EXPECT_TRUE(table.Says("the bag, "));
  table.Take(ToolKind::kBag);
  EXPECT_TRUE(table.Says("into the bag"));
  table.now.operation.is_in_bag = true;
  EXPECT_TRUE(table.Says("Draw the bag out"));
  table.now.operation.is_completed = true;
  EXPECT_TRUE(table.Next().text.empty());
}

TEST(OperationGuide, MarksTheNearestFibreThatIsStillThere) {
  Table table;
  table.now.operation.assistant.is_holding = true;
  table.now.instruments[kLeft].is_grasping = true;
  table.Take(ToolKind::kHook);
  table.now.instruments[kRight].X_world_tool.translation = {0.01, 0, 0};
  ASSERT_TRUE(table.Next().target.has_value());
  EXPECT_NEAR(table.Next().target->x, 0.001, 1e-12);
  table.now.operation.strand_is_intact[0] = 0;
  EXPECT_NEAR(table.Next().target->x, 0.051, 1e-12);
  table.now.operation.procedure.view.criteria = {2, 0, 0};
  EXPECT_NEAR(table.Next().target->y, 0.091, 1e-12) << "now the bed";
  const auto mark = MarkOperationStep(table.Next(), {});
  ASSERT_TRUE(mark.has_value());
  for (const math::Vec3& p : mark->points) EXPECT_NEAR(math::Distance(p, *table.Next().target), 0.006, 1e-12);
  EXPECT_FALSE(MarkOperationStep({}, {}).has_value());
}

TEST(OperationGuide, NamesTheKeysAsTheyAre) {
  const KeyBindings bindings;
  for (const std::string_view text : OperationStepTexts())
    EXPECT_EQ(bindings.Fill(std::string(text)).find('{'), std::string::npos) << text;
}

}  // namespace
}  // namespace trocar::presenter
