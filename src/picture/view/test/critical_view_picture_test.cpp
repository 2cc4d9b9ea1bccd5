// SPDX-License-Identifier: Apache-2.0
// The doublet: two pictures of one state, from two sides of the cystic duct, drawn without changing anything.
#include "trocar/view/critical_view_picture.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"

#include <gtest/gtest.h>

#include <memory>

#include "trocar/scene/scene.h"
#include "trocar/scene/task.h"

namespace trocar::view {
namespace {

base::Result<simulation::Simulation> MakeOperation() {
  auto scene = files::FindOperation("cholecystectomy", {}, 1);
  EXPECT_TRUE(scene.ok() && scene->has_value());
  return simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(**scene)));
}

TEST(CriticalViewDoublet, ShowsTwoSidesAndLeavesTheStateAlone) {
  auto simulation = MakeOperation();
  ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
  for (int i = 0; i < 3; ++i) simulation->Step({});
  const std::uint64_t hash = simulation->Hash();
  const auto doublet = RenderCriticalViewDoublet(*simulation, 320, 180);
  ASSERT_TRUE(doublet.ok()) << doublet.error().Text();
  EXPECT_EQ(simulation->Hash(), hash);
  EXPECT_LT(doublet->front.azimuth, 0);
  EXPECT_GT(doublet->back.azimuth, 0);
  EXPECT_EQ(doublet->front.image.width, 320);
  EXPECT_EQ(doublet->back.image.height, 180);
  EXPECT_GT(render::CalcMeanDifference(doublet->front.image, doublet->back.image), 3);
  const auto again = RenderCriticalViewDoublet(*simulation, 320, 180);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->front.image, doublet->front.image);
}

TEST(CriticalViewDoublet, ShowsNeitherSmokeNorPools) {
  simulation::Snapshot seen;
  seen.operation.smoke = 0.4;
  surgery::FluidLedger& fluids = seen.operation.flow.ledger;
  fluids.Leak(surgery::Fluid::kBlood, 9e-6);
  fluids.Leak(surgery::Fluid::kBile, 2e-6);
  fluids.Rinse(50e-6);
  const simulation::Snapshot shown = ClearField(seen);
  EXPECT_EQ(shown.operation.smoke, 0);
  EXPECT_NEAR(shown.operation.flow.ledger.Pooled(), 0, 1e-12);
  EXPECT_NEAR(seen.operation.flow.ledger.Pooled(), 61e-6, 1e-12) << "the operation itself is left alone";
}

// The views are seen one after the other: each picture is of its own moment.
TEST(CriticalViewDoublet, DrawsEachSideAtItsOwnMoment) {
  auto first = MakeOperation(), second = MakeOperation();
  ASSERT_TRUE(first.ok() && second.ok());
  for (int i = 0; i < 3; ++i) first->Step({});
  scene::Input elsewhere = scene::CalcScriptInput(second->GetScene(), 0);
  elsewhere.hands[0].depth += 0.03;
  for (int i = 0; i < 30; ++i) second->Step(elsewhere);
  const auto early = RenderCriticalViewDoublet(*first, 320, 180),
             late = RenderCriticalViewDoublet(*second, 320, 180),
             both = RenderCriticalViewDoublet(*first, *second, 320, 180);
  ASSERT_TRUE(early.ok() && late.ok() && both.ok());
  EXPECT_EQ(both->front.image, early->front.image);
  // the second picture's exposure remembers the first one
  const auto differ = [](const render::Image& a, const render::Image& b) {
    return render::CalcMeanDifference(a, b);
  };
  const double moments = differ(early->back.image, late->back.image);
  EXPECT_GT(moments, 0);
  EXPECT_LT(differ(both->back.image, late->back.image), 0.2 * moments);
}

TEST(CriticalViewMoments, AreThoseAtWhichTheViewsOfTheVerdictCameToCount) {
  CriticalViewMoments moments;
  int saved = 0;
  const auto step = [&](double time, std::uint8_t points, std::uint8_t from_front, std::uint8_t from_behind) {
    moments.AfterStep({{points, points, points}, {from_front, from_behind}}, time,
                      [&](std::vector<std::byte>& state) {
                        state.assign(1, std::byte{1});
                        ++saved;
                      });
  };
  step(1, 1, 0, 0);
  step(2, 2, 1, 0);
  EXPECT_FALSE(moments.IsAchieved());
  step(3, 1, 0, 0);  // a criterion was lost: what was seen is forgotten
  step(4, 2, 0, 1);
  step(5, 2, 0, 1);
  step(6, 2, 1, 1);
  step(7, 2, 1, 1);
  step(8, 1, 0, 0);
  EXPECT_TRUE(moments.IsAchieved());
  EXPECT_EQ(moments.Front().time, 6);
  EXPECT_EQ(moments.Behind().time, 4);
  EXPECT_EQ(moments.Time(), 6);
  EXPECT_FALSE(moments.Front().state.empty());
  EXPECT_FALSE(moments.Behind().state.empty());
  EXPECT_EQ(saved, 3) << "once a view";
}

TEST(CriticalViewDoublet, RefusesASceneWithoutDuctsAndASizeOfNothing) {
  const auto path = files::FindTask("peg_transfer");
  auto scene = files::ReadTask(*path);
  ASSERT_TRUE(scene.ok());
  auto pegs = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)));
  ASSERT_TRUE(pegs.ok());
  EXPECT_EQ(RenderCriticalViewDoublet(*pegs).error().code, base::ErrorCode::kUsage);
  auto operation = MakeOperation();
  ASSERT_TRUE(operation.ok());
  EXPECT_EQ(RenderCriticalViewDoublet(*operation, 8, 8).error().code, base::ErrorCode::kUsage);
}

}  // namespace
}  // namespace trocar::view
