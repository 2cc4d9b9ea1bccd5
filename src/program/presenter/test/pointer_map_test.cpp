// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/pointer_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::presenter {
namespace {

using instrument::CalcToolPose;
using instrument::TrocarJoints;
using math::Vec3;

// Property: a small step of the joints along the map moves the tip by that step along the picture's axis.
TEST(PointerMap, MovesTheTipAlongThePicturesAxes) {
  math::Random random(7);
  const Vec3 port{0.01, -0.02, 0.03};
  for (int trial = 0; trial < 200; ++trial) {
    const TrocarJoints joints{random.Uniform(-1.2, 1.2), random.Uniform(-1.2, 1.2), random.Uniform(-3, 3),
                              random.Uniform(0.05, 0.28), 0.2};
    math::Pose X_world_view;
    X_world_view.rotation = math::Normalized(math::Quaternion{random.Uniform(-1, 1), random.Uniform(-1, 1),
                                                              random.Uniform(-1, 1), random.Uniform(-1, 1)});
    const device::PointerMap map = CalcPointerMap(joints, X_world_view);
    const double step = 1e-6;
    const std::pair<device::JointRates, Vec3> axes[] = {
        {map.right, {1, 0, 0}}, {map.up, {0, 1, 0}}, {map.away, {0, 0, -1}}};
    for (const auto& [rates, p_view] : axes) {
      TrocarJoints moved = joints;
      moved.pan += step * rates.pan;
      moved.tilt += step * rates.tilt;
      moved.depth += step * rates.depth;
      const Vec3 way = CalcToolPose(port, moved).translation - CalcToolPose(port, joints).translation;
      const Vec3 wanted = step * math::Rotate(X_world_view.rotation, p_view);
      EXPECT_LT(math::Distance(way, wanted), 1e-4 * step) << "trial " << trial;
    }
  }
}

// Property: what goes along the line of sight stays on its spot of the picture.
TEST(PointerMap, KeepsTheTipOnItsSpotAlongTheLineOfSight) {
  math::Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const math::Pose X_world_view{
        math::Normalized(math::Quaternion{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1),
                                          random.Uniform(-1, 1)}),
        {random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1)}};
    const Vec3 p_view{random.Uniform(-0.03, 0.03), random.Uniform(-0.03, 0.03), random.Uniform(-0.12, -0.05)};
    const Vec3 along = CalcSightLine(X_world_view, X_world_view * p_view);
    const Vec3 later = p_view + 0.02 * along;
    EXPECT_NEAR(later.x / later.z, p_view.x / p_view.z, 1e-12);
    EXPECT_NEAR(later.y / later.z, p_view.y / p_view.z, 1e-12);
    EXPECT_LT(later.z, p_view.z) << "away from the lens";
  }
  EXPECT_EQ(CalcSightLine({}, {0.02, 0, -0.001}), (Vec3{0, 0, -1})) << "beside the lens";
  EXPECT_EQ(CalcSightLine({}, {0, 0, 0.1}), (Vec3{0, 0, -1})) << "behind the lens";
}

TEST(PointerMap, StaysFiniteWhereTheShaftIsSingular) {
  for (const TrocarJoints& joints :
       {TrocarJoints{0, 0, 0, 0, 0}, TrocarJoints{0.3, 1.5707963267948966, 0, 0.1, 0},
        TrocarJoints{0, -1.6, 0, 0.1, 0}}) {
    const device::PointerMap map = CalcPointerMap(joints, {});
    for (const device::JointRates& rates : {map.right, map.up, map.away}) {
      EXPECT_LE(std::fabs(rates.pan), 100.0 + 1e-9);
      EXPECT_LE(std::fabs(rates.tilt), 100.0 + 1e-9);
      EXPECT_LE(std::fabs(rates.depth), 1.0 + 1e-9);
    }
  }
}

TEST(PointerMap, PixelIsAsLargeAsThePictureAtTheTip) {
  // 90 deg over 200 pixels at 0.1 m: 0.2 m wide, 1 mm a pixel
  EXPECT_NEAR(CalcMetresPerPixel({}, {0, 0, -0.1}, 1.5707963267948966, 200), 1e-3, 1e-12);
  EXPECT_NEAR(CalcMetresPerPixel({}, {0.02, 0.01, -0.05}, 1.5707963267948966, 400), 2.5e-4, 1e-12);
  EXPECT_EQ(CalcMetresPerPixel({}, {0, 0, 0.1}, 1.5, 400), 1e-5) << "behind the lens";
  EXPECT_EQ(CalcMetresPerPixel({}, {0, 0, NAN}, 1.5, 400), 1e-4);
}

}  // namespace
}  // namespace trocar::presenter
