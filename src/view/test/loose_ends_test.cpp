// SPDX-License-Identifier: Apache-2.0
#include "loose_ends.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace trocar::view {
namespace {

using math::Vec3;

double CalcNearest(const std::vector<FatLobule>& lobules, const Vec3& p) {
  double nearest = 1;
  for (const FatLobule& lobule : lobules)
    nearest = std::min(nearest, math::Distance(lobule.centre, p) - lobule.radius);
  return nearest;
}

TEST(LooseEnds, AreCoveredAndWhereTubesMeetNothingIs) {
  const TubeLine trunk = {{0, 0, 0}, {0.05, 0, 0}, {0.1, 0, 0}};
  const TubeLine branch = {{0.05, 0.004, 0}, {0.05, 0.04, 0}};
  const std::vector<Vec3> organ = {{0, 0.003, 0}};
  const auto lobules = CoverLooseEnds(std::vector<TubeLine>{trunk, branch}, organ);
  EXPECT_LT(CalcNearest(lobules, {0.1, 0, 0}), 0.0) << "in the air";
  EXPECT_LT(CalcNearest(lobules, {0.135, 0, 0}), 0.003) << "and beyond";
  EXPECT_LT(CalcNearest(lobules, {0.05, 0.04, 0}), 0.0);
  EXPECT_GT(CalcNearest(lobules, {0, 0, 0}), 0.02) << "at the organ";
  EXPECT_GT(CalcNearest(lobules, {0.05, 0.004, 0}), 0.01) << "at the trunk";
  EXPECT_TRUE(CoverLooseEnds(std::vector<TubeLine>{{{0, 0, 0}}}, {}).empty());
}

}  // namespace
}  // namespace trocar::view
