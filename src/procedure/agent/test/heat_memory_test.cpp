// SPDX-License-Identifier: Apache-2.0
#include "heat_memory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::agent {
namespace {

TEST(HeatMemory, AddsUpWhatFlowedNearby) {
  HeatMemory memory;
  EXPECT_EQ(memory.At({0, 0, 0}), 0.0);
  memory.Add({0, 0, 0}, 0.2);
  memory.Add({0.0001, 0, 0}, 0.1);                     // the same place
  memory.Add({0.8 * HeatMemory::kReach, 0, 0}, 0.05);  // another, that reaches here
  memory.Add({2.0 * HeatMemory::kReach, 0, 0}, 1.0);   // one that does not
  EXPECT_NEAR(memory.At({0, 0, 0}), 0.35, 1e-12);
  EXPECT_NEAR(memory.At({0, 1.5 * HeatMemory::kReach, 0}), 0.0, 1e-12);
}

TEST(HeatMemory, ForgetsAsAPlaceCools) {
  HeatMemory memory;
  memory.Add({0, 0, 0}, 0.4);
  for (int tick = 0; tick < 120; ++tick) memory.Cool(HeatMemory::kCools / 120);
  EXPECT_NEAR(memory.At({0, 0, 0}), 0.4 * std::exp(-1.0), 1e-9);
  memory.Cool(100.0);
  EXPECT_EQ(memory.At({0, 0, 0}), 0.0);
}

}  // namespace
}  // namespace trocar::agent
