// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/blade.h"

#include <gtest/gtest.h>

#include <array>

#include "trocar/surgery/cuttable_tubes.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

TEST(Blade, ScissorsCutWhileTheyCloseFromHingeToTip) {
  instrument::Tool tool;
  const BladeSettings settings;
  BladeState state;
  EXPECT_FALSE(MoveBlade(tool, {}, tool.max_jaw, false, settings, state).has_value());  // opening
  const Vec3 hinge = instrument::JawHinge(tool);
  double reached = 0;
  for (int i = 9; i >= 0; --i) {
    const auto move = MoveBlade(tool, {}, tool.max_jaw * i / 10, false, settings, state);
    ASSERT_TRUE(move.has_value());
    // the piece between the blades stands across the tool's axis, ever farther from the hinge
    const Vec3 middle = 0.5 * (move->now.a + move->now.b);
    EXPECT_NEAR(middle.y, 0.0, 1e-12);
    const double along = math::Distance(middle, hinge);
    EXPECT_GT(along, reached);
    reached = along;
  }
  EXPECT_NEAR(reached, tool.jaw_length, 1e-12);
  EXPECT_FALSE(MoveBlade(tool, {}, 0.0, false, settings, state).has_value());  // closed, and stays so
  EXPECT_FALSE(MoveBlade(tool, {}, 0.5, false, settings, state).has_value());
}

TEST(Blade, AHookCutsWhileItHasPower) {
  const instrument::Tool tool;
  BladeSettings settings;
  settings.kind = BladeKind::kHook;
  BladeState state;
  const auto at = [](double x) { return math::Pose{{}, {x, 0, 0}}; };
  EXPECT_FALSE(MoveBlade(tool, at(0), 0, false, settings, state).has_value());
  const auto first = MoveBlade(tool, at(0.01), 0, true, settings, state);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->before, first->now);  // not from where it was without power
  const auto second = MoveBlade(tool, at(0.02), 0, true, settings, state);
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->before, first->now);
  EXPECT_NEAR(second->now.a.x, 0.02, 1e-15);
  EXPECT_FALSE(MoveBlade(tool, at(0.03), 0, false, settings, state).has_value());
}

constexpr BladeMove kMove{{{-0.001, 0, -0.01}, {-0.001, 0, 0.01}}, {{0.0101, 0, -0.01}, {0.0101, 0, 0.01}}};

TEST(Blade, CutsTheStrandsThatItCrosses) {
  tissue::TissueDefinition definition;
  for (int i = 0; i < 20; ++i) {
    for (const double y : {-0.001, 0.001}) definition.rest.push_back({0.001 * i, y, 0});
    definition.strands.push_back(
        {static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1), 1.0});
  }
  definition.mass.assign(40, 0.0);
  definition.shape_stiffness.assign(40, 1.0);
  const auto model = tissue::MakeTissueModel(definition);
  auto state = tissue::MakeRestState(model);
  state.strand_is_intact[3] = 0;
  TopologyChange change;
  change.cut_strands.resize(64);
  change.cut_strands.resize(FindCutStrands(kMove, definition.strands, state, change.cut_strands));
  EXPECT_EQ(change.cut_strands, (std::vector<std::uint32_t>{0, 1, 2, 4, 5, 6, 7, 8, 9, 10}));
  ApplyChange(change, {}, model, state);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(state.strand_is_intact[i], i > 10 ? 1 : 0);
  EXPECT_EQ(FindCutStrands(kMove, definition.strands, state, change.cut_strands), 0u);
}

struct TubeSystem {
  tissue::TissueDefinition definition;
  std::vector<double> radii;
  TubeSystem() {
    for (int i = 0; i <= 8; ++i) {
      definition.rest.push_back({0.0047, 0.004 * (i - 4) - 0.0011, 0});
      radii.push_back(0.0025);
      definition.mass.push_back(1e-4);
      definition.shape_stiffness.push_back(0.5);
    }
    for (std::uint32_t i = 0; i < 8; ++i) definition.springs.push_back({i, i + 1, 100.0, 0.004});
    for (std::uint32_t i = 0; i < 7; ++i) definition.springs.push_back({i, i + 2, 5.0, 0.008});
  }
};

TEST(CuttableTubes, TwoStumpsShareStiffnessMassAndFoundation) {
  TubeSystem system;
  auto& definition = system.definition;
  const std::vector<Vec3> points = definition.rest;
  const std::uint32_t spare = AddSpareNodes(8, definition);
  CuttableTubes tubes(spare, 8);
  tubes.AddTube(0, points, system.radii);
  TopologyChange change;
  tubes.ReserveFor(change);
  std::array<geometry::CentreLineCut, CuttableTubes::kMostCuts> cuts;
  ASSERT_EQ(tubes.Cut(kMove, definition, definition.rest, change, cuts), 1u);
  const std::uint32_t low = tubes.Node(cuts[0].ends[0]), high = tubes.Node(cuts[0].ends[1]);
  EXPECT_NEAR(cuts[0].t, 0.275, 1e-12);  // y = 0 between -1.1 and 2.9 mm
  ApplyChange(change, definition);

  double mass = 0, foundation = 0;
  for (std::size_t i = 0; i < definition.mass.size(); ++i) {
    mass += definition.mass[i];
    foundation += definition.shape_stiffness[i];
  }
  EXPECT_NEAR(mass, 9e-4, 1e-18);
  EXPECT_NEAR(foundation, 4.5, 1e-14);
  // the springs in series along the line: sum of 1 / k as before, and nothing leads over the cut
  double compliance = 0;
  for (const tissue::Spring& spring : definition.springs) {
    const bool below = (spring.a <= 4 || spring.a == low) && (spring.b <= 4 || spring.b == low);
    const bool above = ((spring.a > 4 && spring.a <= 8) || spring.a == high) &&
                       ((spring.b > 4 && spring.b <= 8) || spring.b == high);
    EXPECT_TRUE(below || above) << spring.a << " " << spring.b;
    EXPECT_NEAR(math::Distance(definition.rest[spring.a], definition.rest[spring.b]), spring.rest_length,
                1e-12);
    if (spring.stiffness > 50.0) compliance += 1.0 / spring.stiffness;
  }
  EXPECT_NEAR(compliance, 8 / 100.0, 1e-12);
  EXPECT_EQ(definition.springs.size(), 8u + 7u + 1u);
  const auto model = tissue::MakeTissueModel(definition);
  EXPECT_EQ(model.is_fixed[low], 0);
  EXPECT_EQ(model.is_fixed[spare + 2], 1);
}

TEST(CuttableTubes, CutsUntilTheSpareNodesAreUsedUp) {
  TubeSystem system;
  auto& definition = system.definition;
  const std::vector<Vec3> points = definition.rest;
  CuttableTubes tubes(AddSpareNodes(2, definition), 2);
  tubes.AddTube(0, points, system.radii);
  TopologyChange change;
  tubes.ReserveFor(change);
  std::array<geometry::CentreLineCut, CuttableTubes::kMostCuts> cuts;
  EXPECT_EQ(tubes.Cut(kMove, definition, definition.rest, change, cuts), 1u);
  const BladeMove other{{{-0.001, 0.009, -0.01}, {-0.001, 0.009, 0.01}},
                        {{0.0101, 0.009, -0.01}, {0.0101, 0.009, 0.01}}};
  EXPECT_EQ(tubes.Cut(other, definition, definition.rest, change, cuts), 0u);
}

}  // namespace
}  // namespace trocar::surgery
