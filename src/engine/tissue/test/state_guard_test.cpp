// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/state_guard.h"

#include <gtest/gtest.h>

#include <limits>

#include "test_systems.h"

namespace trocar::tissue {
namespace {

TEST(StateGuard, RestoresTheLastGoodStateInTheSameTick) {
  const TissueModel model = MakeTissueModel(MakeHangingSpring(20, 0.1, 0.05));
  TissueState state = MakeRestState(model);
  StateGuard guard(model);
  state.position[1].z = -0.11;
  EXPECT_EQ(guard.Check(state), GuardVerdict::kGood);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 3.0}) {
    state.position[1].x = bad;
    EXPECT_EQ(guard.Check(state), GuardVerdict::kRestored) << bad;
    EXPECT_EQ(state.position[1], (math::Vec3{0, 0, -0.11}));
    EXPECT_EQ(guard.Check(state), GuardVerdict::kGood);
  }
}

TEST(StateGuard, FreezesAfterThreeBadTicksInARowUntilReleased) {
  const TissueModel model = MakeTissueModel(MakeHangingSpring(20, 0.1, 0.05));
  TissueState state = MakeRestState(model);
  StateGuard guard(model);
  GuardVerdict verdict = GuardVerdict::kGood;
  for (int tick = 0; tick < StateGuard::kMaxRetries; ++tick) {
    state.position[1].y = std::numeric_limits<double>::quiet_NaN();
    verdict = guard.Check(state);
  }
  EXPECT_EQ(verdict, GuardVerdict::kFrozen);
  EXPECT_EQ(guard.Check(state), GuardVerdict::kFrozen) << "even a good state stays held";
  guard.Release(state);
  EXPECT_EQ(guard.Check(state), GuardVerdict::kGood);
}

}  // namespace
}  // namespace trocar::tissue
