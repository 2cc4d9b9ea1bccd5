// SPDX-License-Identifier: Apache-2.0
// The hook on a made-up row of fibres that part where current flows through them for a moment.
#include "hook_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fibre_choice.h"
#include "planner_hands.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr double kPartsAfter = 0.1;  // of current [s]
constexpr double kSpacing = 0.006;   // of the fibres, along x [m]

/// Fibres of 4 mm that stand upright, under trocars 15 cm above; the lens looks down on them.
struct Row {
  std::vector<scene::StrandInfo> strands;
  std::vector<Vec3> rest;
  std::vector<std::uint8_t> is_intact;
  std::vector<double> heated;       // [s]
  std::vector<std::uint32_t> main;  // nodes of a duct that must stay
  HandMotion hook = HandAt({0.01, 0.01, 0.15}, {0, 0, 0.03});
  HandMotion hold = HandAt({-0.05, 0, 0.15}, {-0.01, 0.01, 0});
  bool coagulate = false;
  HookField field;
  Dissection work;
  HeatMemory heat;
  double seconds = 0;
  double least_to_main = 1.0;  // of the hook's tip, while current flows [m]
  int unseen_ticks = 0;        // with current, for a lens that sees nothing

  explicit Row(std::uint32_t count, DissectionGoal goal = {}) {
    for (std::uint32_t i = 0; i < count; ++i) {
      scene::StrandInfo strand;
      strand.a = 2 * i;
      strand.b = 2 * i + 1;
      strands.push_back(strand);
      rest.push_back({kSpacing * i, 0, 0.002});
      rest.push_back({kSpacing * i, 0, -0.002});
      goal.strands.push_back(i);
      goal.order.push_back(0);
    }
    is_intact.assign(count, 1);
    heated.assign(count, 0);
    work = PlanDissection(std::move(goal), {0, 1, 0}, {1, 0, 0});
    work.traction.p_hold = hold.Tip();
    field.X_world_lens.translation = {0.02, 0, 0.10};
    field.field_of_view = 1.3;
    field.dt = kTestTick;
    field.held = {true, {}};
    field.clearance = [](const collision::Segment&) { return 0.03; };
    field.is_reached = [](const DissectionGoal&) { return false; };
    field.X_world_hook = StepTool(hook);
    Refer();
  }
  void Refer() {
    field.strands = strands;
    field.rest = field.positions = rest;
    field.is_intact = is_intact;
    field.main_ducts = main;
  }
  /// A duct that must stay, beside the last fibre.
  void AddMainDuct() {
    main = {static_cast<std::uint32_t>(rest.size())};
    rest.push_back(rest[rest.size() - 2] + Vec3{0.003, 0, 0});
    Refer();
  }
  std::size_t Left() const {
    return static_cast<std::size_t>(std::count(is_intact.begin(), is_intact.end(), 1));
  }
  /// \return whether the work was over within the time
  bool Play(double most_seconds) {
    for (; seconds < most_seconds; seconds += kTestTick) {
      if (StepDissection(field, work, heat, seconds, {hook, hold, coagulate})) return true;
      field.X_world_hook = StepTool(hook);
      (void)StepTool(hold);
      if (!coagulate) continue;
      for (const std::uint32_t node : main)
        least_to_main = std::min(least_to_main, math::Distance(rest[node], field.X_world_hook.translation));
      for (std::uint32_t i = 0; i < strands.size(); ++i) {
        if (field.Gap(i).squared_distance < 0.0009 * 0.0009) heated[i] += kTestTick;
        if (heated[i] > kPartsAfter) is_intact[i] = 0;
      }
    }
    return false;
  }
};

TEST(HookPlanner, PartsEachFibreAndLiftsTheFoot) {
  Row row(6);
  EXPECT_TRUE(row.Play(60));
  EXPECT_EQ(row.Left(), 0u);
  EXPECT_FALSE(row.coagulate);
}

TEST(HookPlanner, StopsWhereEnoughIsParted) {
  DissectionGoal goal;
  goal.enough = 0.5;
  Row row(6, goal);
  EXPECT_TRUE(row.Play(60));
  EXPECT_EQ(row.Left(), 3u);
  Row reached(6);
  reached.field.is_reached = [](const DissectionGoal&) { return true; };
  EXPECT_TRUE(reached.Play(60));
  EXPECT_EQ(reached.Left(), 6u);
}

TEST(HookPlanner, LeavesAFibreBesideADuctThatMustStay) {
  Row row(6);
  row.AddMainDuct();
  EXPECT_TRUE(row.Play(200)) << "it ends although a fibre is left";
  EXPECT_EQ(row.is_intact.back(), 1);
  EXPECT_EQ(row.Left(), 1u);
  EXPECT_GT(row.least_to_main, 0.0055);
}

TEST(HookPlanner, PressesNoPedalOutOfThePicture) {
  Row row(3);
  row.field.X_world_lens.translation = {0.5, 0, 0.10};
  EXPECT_TRUE(row.Play(200));
  EXPECT_EQ(row.Left(), 3u);
}

TEST(HookPlanner, TurnsBackFromWhatPushesTheHook) {
  Row row(1);
  row.field.hook_force = {0, 0, 5};
  EXPECT_TRUE(row.Play(200));
  EXPECT_EQ(row.Left(), 1u);
  EXPECT_EQ(row.work.attempts[0], 3);
}

TEST(HookPlanner, SwingsTheHeldTissueWhereNoFibreLiesOpen) {
  DissectionGoal goal;
  goal.traction = 0.030;
  goal.way = {0, 0, 1};
  Row row(3, goal);
  row.field.clearance = [](const collision::Segment&) { return 0.0; };
  const Vec3 before = row.hold.Tip();
  (void)row.Play(20);
  EXPECT_GT(row.work.traction.way, 0u);
  EXPECT_GT(math::Distance(row.hold.Tip(), before), 0.008);
}

TEST(ChooseFibre, TakesTheStretchedOneFirst) {
  Row row(5);
  row.rest[7] = row.rest[7] - Vec3{0, 0, 0.004};  // the lower end of the fourth fibre
  const std::vector<Vec3> stretched = row.rest;
  row.rest[7] = row.rest[7] + Vec3{0, 0, 0.004};
  row.field.positions = stretched;
  ChooseFibre(row.field, row.work, row.heat, row.hook);
  EXPECT_EQ(row.work.target.fibre, 3);
}

TEST(ChooseFibre, WaitsWhereEveryPlaceIsWarm) {
  Row row(2);
  for (std::uint32_t i = 0; i < 2; ++i) row.heat.Add(row.field.HookedPoint(i), 0.3);
  ChooseFibre(row.field, row.work, row.heat, row.hook);
  EXPECT_EQ(row.work.target.fibre, -1);
  EXPECT_TRUE(row.work.waits);
  row.heat.Cool(20);
  ChooseFibre(row.field, row.work, row.heat, row.hook);
  EXPECT_GE(row.work.target.fibre, 0);
}

TEST(HookField, TakesAFibreAwayFromWhereAVesselEnters) {
  Row row(1);
  const Vec3 middle = row.field.HookedPoint(0);
  EXPECT_LT(math::Norm(middle), 1e-12);
  const Vec3 entry = middle + Vec3{0, 0, 0.001};
  row.field.entries = {{entry, entry + Vec3{0.01, 0, 0}}};
  EXPECT_GT(math::Distance(row.field.HookedPoint(0), middle), 0.0005);
  EXPECT_NEAR(row.field.EntryDistance({entry + Vec3{0, 0.004, 0}, entry + Vec3{0, 0.005, 0}}), 0.004, 1e-12);
}

}  // namespace
}  // namespace trocar::agent
