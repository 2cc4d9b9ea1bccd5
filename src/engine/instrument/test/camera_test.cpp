// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::instrument {
namespace {

// The laparoscope looks along -z.
TEST(IsInView, IsAConeInFrontOfTheLens) {
  const double fov = 1.2;
  EXPECT_TRUE(IsInView({}, fov, {0, 0, -0.1}));
  EXPECT_FALSE(IsInView({}, fov, {0, 0, 0.1}));
  EXPECT_FALSE(IsInView({}, fov, {0, 0, 0}));
  EXPECT_TRUE(IsInView({}, fov, {0.1 * std::tan(0.59), 0, -0.1}));
  EXPECT_FALSE(IsInView({}, fov, {0, 0.1 * std::tan(0.61), -0.1}));
  // moved and turned to look along +x
  const math::Pose X_world_laparoscope{math::RotationAbout({0, 1, 0}, -M_PI / 2), {1, 2, 3}};
  EXPECT_TRUE(IsInView(X_world_laparoscope, fov, {1.1, 2, 3}));
  EXPECT_FALSE(IsInView(X_world_laparoscope, fov, {0.9, 2, 3}));
}

}  // namespace
}  // namespace trocar::instrument
