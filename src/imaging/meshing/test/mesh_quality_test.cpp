// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_quality.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/primitives.h"

namespace trocar::meshing {
namespace {

using math::Vec3;

TEST(CalcSurfaceDistance, OfConcentricSpheresIsTheDifferenceOfTheirRadii) {
  const auto inner = geometry::MakeSphere({0, 0, 0}, 20, 5), outer = geometry::MakeSphere({0, 0, 0}, 22, 5);
  const SurfaceDistance distance = CalcSurfaceDistance(inner, outer, 20000);
  EXPECT_NEAR(distance.mean_from_mesh, 2.0, 0.03);
  EXPECT_NEAR(distance.mean_from_reference, 2.0, 0.03);
  EXPECT_NEAR(distance.Hausdorff(), 2.0, 0.05);
  EXPECT_GE(distance.mesh_samples, 19000u);
}

TEST(CalcSurfaceDistance, SeesASpikeFromTheSideThatHasIt) {
  const auto ball = geometry::MakeSphere({0, 0, 0}, 20, 4);
  auto spiked = ball;
  spiked.positions[5] = 1.5 * spiked.positions[5];
  const SurfaceDistance from_mesh = CalcSurfaceDistance(spiked, ball, 5000);
  EXPECT_NEAR(from_mesh.largest_from_mesh, 10.0, 0.1);
  EXPECT_LT(from_mesh.largest_from_reference, 1.5);
  EXPECT_NEAR(from_mesh.Hausdorff(), 10.0, 0.1);
  const SurfaceDistance from_ball = CalcSurfaceDistance(ball, spiked, 5000);
  EXPECT_LT(from_ball.largest_from_mesh, 1.5);
  EXPECT_NEAR(from_ball.Hausdorff(), 10.0, 0.1);
}

TEST(InspectQuality, OfAMeshAgainstItselfIsPerfect) {
  const auto mesh = geometry::MakeSphere({3, 0, 0}, 20, 3);
  const MeshQuality quality = InspectQuality(mesh, mesh, 3000);
  EXPECT_TRUE(quality.IsSound());
  EXPECT_EQ(quality.volume_change, 0.0);
  EXPECT_LT(quality.distance.Hausdorff(), 1e-12);
  EXPECT_GT(quality.surface.mean_min_angle, quality.surface.min_angle);
  EXPECT_EQ(InspectQuality(mesh, mesh, 0).distance.mesh_samples, 0u);
}

TEST(InspectQuality, IsNotSoundWhereSomethingIsWrong) {
  const auto good = geometry::MakeSphere({0, 0, 0}, 20, 2);
  auto open = good;
  open.triangles.pop_back();
  EXPECT_FALSE(InspectQuality(open, good, 0).IsSound());
  auto cut = good;
  cut.positions[7] = -1.5 * cut.positions[7];
  EXPECT_GT(InspectQuality(cut, good, 0).self_intersections, 0u);
  EXPECT_FALSE(InspectQuality(cut, good, 0).IsSound());
}

}  // namespace
}  // namespace trocar::meshing
