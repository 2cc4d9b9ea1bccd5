// SPDX-License-Identifier: Apache-2.0
// Between a device and the world: places, forces, and how stiff the spring may be.
#include "trocar/haptics/coupling.h"

#include <gtest/gtest.h>

namespace trocar::haptics {
namespace {

TEST(Coupling, MapsThereAndBackAndScalesForces) {
  DeviceMap map;
  map.X_world_device = {{0.8, 0, 0, 0.6}, {0.1, -0.2, 0.3}};
  map.motion_scale = 2;
  map.force_scale = 0.5;
  const math::Vec3 p{0.01, 0.02, -0.03};
  const math::Vec3 there = ToWorld(map, p);
  EXPECT_NEAR(math::Distance(there, map.X_world_device.translation), 2 * math::Norm(p), 1e-12);
  EXPECT_NEAR(math::Distance(ToDevice(map, there), p), 0.0, 1e-12);
  const math::Vec3 force = ToDeviceForce(map, math::Rotate(map.X_world_device.rotation, {0, 3, 0})).newton;
  EXPECT_NEAR(math::Distance(force, {0, 1.5, 0}), 0.0, 1e-12);
  EXPECT_EQ(CalcCouplingStiffness(map, 400), 400.0) << "2 x 0.5";
  map.force_scale = 2;
  EXPECT_EQ(CalcCouplingStiffness(map, 400), 100.0);
}

// K <= min(2 b / T, 2 f / Delta, the maker's)
TEST(Coupling, TheStiffestSpringIsTheSoftestBound) {
  device::ForceLimits limits;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 200.0) << "of a device of which nothing is known";
  limits.damping = 0.2;
  EXPECT_NEAR(CalcStiffnessCap(limits, 0.001), 400.0, 1e-9);
  EXPECT_NEAR(CalcStiffnessCap(limits, 0.002), 200.0, 1e-9);
  limits = {};
  limits.damping = 0.01;
  EXPECT_NEAR(CalcStiffnessCap(limits, 0.001), 20.0, 1e-9);
  limits = {};
  limits.friction = 0.06;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 200.0) << "friction means nothing without the encoders' step";
  limits.position_step = 0.001;
  EXPECT_NEAR(CalcStiffnessCap(limits, 0.001), 120.0, 1e-9);
  limits.friction = 0.0;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 200.0);
  limits.max_stiffness = 90.0;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 90.0);
  limits.max_stiffness = 0.125;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 0.125);
}

}  // namespace
}  // namespace trocar::haptics
