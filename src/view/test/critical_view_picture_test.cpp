// SPDX-License-Identifier: Apache-2.0
// The doublet: two pictures of one state, from two sides of the cystic duct, drawn without changing anything.
#include "trocar/view/critical_view_picture.h"

#include <gtest/gtest.h>

#include <memory>

#include "trocar/scene/scene.h"
#include "trocar/scene/task.h"

namespace trocar::view {
namespace {

core::Result<simulation::Simulation> MakeOperation() {
  auto scene = scene::FindOperation("cholecystectomy", {}, 1);
  EXPECT_TRUE(scene.ok() && scene->has_value());
  return simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(**scene)), 1);
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

TEST(CriticalViewDoublet, RefusesASceneWithoutDuctsAndASizeOfNothing) {
  const auto path = scene::FindTask("peg_transfer");
  auto scene = scene::ReadTask(*path);
  ASSERT_TRUE(scene.ok());
  auto pegs = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)), 1);
  ASSERT_TRUE(pegs.ok());
  EXPECT_EQ(RenderCriticalViewDoublet(*pegs).error().code, core::ErrorCode::kUsage);
  auto operation = MakeOperation();
  ASSERT_TRUE(operation.ok());
  EXPECT_EQ(RenderCriticalViewDoublet(*operation, 8, 8).error().code, core::ErrorCode::kUsage);
}

}  // namespace
}  // namespace trocar::view
