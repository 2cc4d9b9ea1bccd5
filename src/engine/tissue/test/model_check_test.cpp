// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/model_check.h"

#include <gtest/gtest.h>

#include <limits>

#include "test_systems.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/state_guard.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TissueDefinition MakeGood() {
  return MakeMembrane(geometry::MakeGrid(4, 0.01), 100.0, 1e4);
}

TEST(CheckTissue, LeavesAGoodModelAlone) {
  TissueDefinition definition = MakeGood();
  const auto repairs = CheckTissue(definition);
  ASSERT_TRUE(repairs.ok());
  EXPECT_EQ(repairs->Text(), "");
  EXPECT_EQ(definition.springs.size(), MakeGood().springs.size());
}

TEST(CheckTissue, NamesWhatCannotBeSolved) {
  const auto code = [](const auto& spoil) {
    TissueDefinition definition = MakeGood();
    spoil(definition);
    const auto checked = CheckTissue(definition);
    return checked.ok() ? base::ErrorCode{} : checked.error().code;
  };
  const auto bad = base::ErrorCode::kTissueInvalid;
  EXPECT_EQ(code([](auto& d) { d.rest[3].y = kNaN; }), bad);
  EXPECT_EQ(code([](auto& d) { d.mass[3] = -1; }), bad);
  EXPECT_EQ(code([](auto& d) { d.mass.pop_back(); }), bad);
  EXPECT_EQ(code([](auto& d) { d.shape_stiffness[3] = INFINITY; }), bad);
  EXPECT_EQ(code([](auto& d) { d.springs[3].stiffness = kNaN; }), bad);
  EXPECT_EQ(code([](auto& d) { d.springs[3].rest_length = -0.1; }), bad);
  EXPECT_EQ(code([](auto& d) { d.springs[3].b = 999; }), bad);
  EXPECT_EQ(code([](auto& d) { d.springs[3].b = d.springs[3].a; }), bad);
  EXPECT_EQ(code([](auto& d) { d.rest[d.springs[3].b] = d.rest[d.springs[3].a]; }), bad);
  EXPECT_EQ(code([](auto& d) { d.strands = {{0, 99, 1.0}}; }), bad);
  EXPECT_EQ(code([](auto& d) { d.fixed = {99}; }), bad);
}

// The repaired model exerts the very forces of the two springs.
TEST(CheckTissue, JoinsDuplicateSpringsIntoOneOfTheSameForce) {
  TissueDefinition definition = MakeHangingSpring(20.0, 0.1, 0.05);
  definition.springs.push_back({1, 0, 30.0, 0.12});
  const auto repairs = CheckTissue(definition);
  ASSERT_TRUE(repairs.ok());
  EXPECT_EQ(repairs->merged_springs, 1u);
  EXPECT_NE(repairs->Text().find("duplicate"), std::string::npos);
  ASSERT_EQ(definition.springs.size(), 1u);
  EXPECT_DOUBLE_EQ(definition.springs[0].stiffness, 50.0);
  EXPECT_NEAR(50.0 * (0.2 - definition.springs[0].rest_length), 20.0 * (0.2 - 0.1) + 30.0 * (0.2 - 0.12),
              1e-12);
}

TEST(CheckTissue, FixesANodeThatNothingHolds) {
  TissueDefinition definition = MakeHangingSpring(20.0, 0.1, 0.05);
  definition.rest.push_back({1, 2, 3});
  definition.mass.push_back(0.1);
  definition.shape_stiffness.push_back(0.0);
  const auto repairs = CheckTissue(definition);
  ASSERT_TRUE(repairs.ok());
  EXPECT_EQ(repairs->held_nodes, 1u);
  const TissueModel model = MakeTissueModel(definition);
  for (const SolverKind kind : kSolverKinds) {
    TissueState state = MakeRestState(model);
    EquilibriumSolver solver(model);
    (void)solver.Solve({kind, 100, 1e-6, 0.0}, {.gravity = {0, 0, -9.81}}, state);
    EXPECT_EQ(state.position[2], (Vec3{1, 2, 3})) << SolverName(kind);
  }
}

TEST(CheckTissue, RefusesMoreThanTheMemory) {
  TissueDefinition definition = MakeGood();
  const auto checked = CheckTissue(definition, 1000);
  ASSERT_FALSE(checked.ok());
  EXPECT_EQ(checked.error().code, base::ErrorCode::kOutOfMemory);
}

TEST(CheckSolverSettings, NamesAnUnstableStepAndTheLargestThatIsNot) {
  const TissueModel model = MakeTissueModel(MakeGood());
  const double largest = CalcLargestAlpha(model, {});
  SolverSettings settings{SolverKind::kRelaxationPaper, 100, 1e-4, largest};
  EXPECT_TRUE(CheckSolverSettings(settings, model, {}).ok());
  settings.relaxation.alpha = 1.01 * largest;
  const auto status = CheckSolverSettings(settings, model, {});
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kUnstableStep);
}

// A NaN or infinity in anything that a tick takes is found in that tick: by the guard in the positions, by
// the solve in everything else.
TEST(Faults, ANaNInAnyArrayIsFoundInItsTick) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 2);
  const TissueModel model = MakeTissueModel(MakeMembrane(mesh, 100.0, 2e4));
  for (const SolverKind kind : kSolverKinds) {
    for (int where = 0; where < 5; ++where) {
      for (const int tick_of_fault : {0, 3}) {
        TissueState state = MakeRestState(model);
        StateGuard guard(model);
        EquilibriumSolver solver(model);
        std::vector<Vec3> external(model.Size());
        ContactSpring contact{{9, 10, 11}, {0.2, 0.3, 0.5}, {0, 0, 1}, 1.0, 0.001};
        TissueLoad load{.gravity = {0, 0, -1}, .contacts = {&contact, 1}, .external_force = external};
        for (int tick = 0; tick < 4; ++tick) {
          const bool is_bad = tick == tick_of_fault;
          if (is_bad && where == 0) state.position[7].z = kNaN;
          if (is_bad && where == 1) external[7].x = kNaN;
          if (is_bad && where == 2) external[7].x = INFINITY;
          if (is_bad && where == 3) contact.offset = kNaN, contact.stiffness = kNaN;
          if (is_bad && where == 4) load.gravity.y = kNaN;
          const SolveReport report = solver.Solve({kind, 20, 1e-4, 0.0}, load, state);
          const GuardVerdict verdict = guard.Check(state, report.is_finite);
          EXPECT_EQ(verdict, is_bad ? GuardVerdict::kRestored : GuardVerdict::kGood)
              << SolverName(kind) << " where " << where << " tick " << tick;
          for (const Vec3& p : state.position) ASSERT_TRUE(math::IsFinite(p));
          if (is_bad) break;
        }
      }
    }
  }
}

}  // namespace
}  // namespace trocar::tissue
