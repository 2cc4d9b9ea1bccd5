// SPDX-License-Identifier: Apache-2.0
// The laparoscope on its way, and after a tool that leaves the picture.
#include "camera_planner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "planner_hands.h"
#include "trocar/instrument/camera.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

scene::LaparoscopeSetup Straight() {
  scene::LaparoscopeSetup setup;
  setup.p_world_port = {0, 0, 0.18};
  return setup;
}

Pose LensOf(const CameraWork& camera) {
  return scene::CalcLaparoscopePose(Straight(), camera.now);
}

TEST(StepCamera, TurnsSteadilyAndArrives) {
  CameraWork camera;
  camera.to = {0.5, -0.2, 1.0, 0.09, 0.0};
  int ticks = 0;
  for (; !camera.HasArrived() && ticks < 10000; ++ticks) {
    const double before = camera.now.pan;
    StepCamera(camera, kTestTick);
    EXPECT_LE(std::fabs(camera.now.pan - before), 0.25 * kTestTick + 1e-12);
  }
  EXPECT_NEAR(ticks * kTestTick, 3.0, 0.02) << "the depth takes longest: 9 cm at 3 cm a second";
}

TEST(AimCamera, PutsThePointIntoTheMiddleOrStays) {
  CameraWork camera;
  const Vec3 p{0.02, 0.01, 0};
  AimCamera(camera, Straight(), p, {0, 0, 1}, 0.08);
  camera.now = camera.to;
  EXPECT_TRUE(instrument::IsInView(LensOf(camera), 0.1, p));
  const CameraWork before = camera;
  AimCamera(camera, Straight(), {0, 0, 5}, {0, 0, 1}, 0.08);
  EXPECT_TRUE(camera.to == before.to) << "outside of the body";
}

TEST(FollowTool, WaitsForAToolThatComesBackAndFollowsOneThatDoesNot) {
  CameraWork camera;
  AimCamera(camera, Straight(), {0, 0, 0}, {0, 0, 1}, 0.09);
  camera.now = camera.to;
  const Vec3 far{0.12, 0, 0};
  const auto look = [&](const Vec3& tip, double depth, double seconds) {
    for (double time = 0; time < seconds; time += kTestTick)
      FollowTool(camera, Straight(), LensOf(camera), tip, depth, {0, 0, 0}, kTestTick);
  };
  look(far, 0.15, 0.2);
  EXPECT_TRUE(camera.HasArrived());
  look({0, 0, 0}, 0.15, 0.2);
  look(far, 0.15, 0.2);
  EXPECT_TRUE(camera.HasArrived()) << "it was in the picture meanwhile";
  look(far, 0.02, 1.0);
  EXPECT_TRUE(camera.HasArrived()) << "a tool that is hardly in the body";
  look(far, 0.15, 0.5);
  ASSERT_FALSE(camera.HasArrived());
  camera.now = camera.to;
  EXPECT_TRUE(instrument::IsInView(LensOf(camera), Straight().field_of_view, 0.5 * far));
}

}  // namespace
}  // namespace trocar::agent
