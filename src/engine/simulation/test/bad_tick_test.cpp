// SPDX-License-Identifier: Apache-2.0
#include "bad_tick.h"

#include <gtest/gtest.h>

namespace trocar::simulation {
namespace {

// A wall that tears after a tick was found good is open in the next one, whatever becomes of that.
TEST(BadTick, TakesBackPressuresButNoOpening) {
  tissue::ConservationState state;
  state.organs.resize(2);
  state.organs[0].target = 30e-6;
  state.organs[0].pressure = 400.0;
  state.last_position = {{0.0, 0.0, 0.1}};
  const tissue::ConservationTick good = state;
  state.organs[0].opening_area = 1e-6;  // torn after the check
  state.organs[0].pressure = 1e9;
  state.organs[1].pressure = -1e9;
  state.last_position = {{0.0, 0.0, 7.0}};
  TakeBack(good, state);
  EXPECT_EQ(state.organs[0].opening_area, 1e-6);
  EXPECT_EQ(state.organs[1].opening_area, 0.0);
  EXPECT_EQ(state.organs[0].pressure, 400.0);
  EXPECT_EQ(state.organs[1].pressure, 0.0);
  EXPECT_EQ(state.organs[0].target, 30e-6);
  EXPECT_EQ(state.last_position[0].z, 0.1);
}

}  // namespace
}  // namespace trocar::simulation
