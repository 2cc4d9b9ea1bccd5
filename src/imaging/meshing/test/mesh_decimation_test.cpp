// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_decimation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/meshing/marching_cubes.h"
#include "trocar/meshing/mesh_smoothing.h"

namespace trocar::meshing {
namespace {

using math::Vec3;

// a torus with bumps as a volume of 1 mm, values in steps of a quarter so that it has stairs
geometry::TriangleMesh MakeBumpyTorus() {
  ScalarVolume volume{1.0, {-32, -32, -14}, {64, 64, 28}, std::vector<float>(64 * 64 * 28)};
  for (int k = 0; k < 28; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) {
        const Vec3 p = volume.Position(i, j, k);
        const double ring = std::hypot(std::hypot(p.x, p.y) - 20, p.z);
        volume.values[volume.Index(i, j, k)] =
            static_cast<float>(7.5 + std::sin(p.x * 0.4) - ring > 0 ? 0.5 : -0.5);
      }
    }
  }
  return MarchCubes(volume);
}

TEST(SmoothMesh, TakesStairsOffAndKeepsTheVolume) {
  auto mesh = MakeBumpyTorus();
  const auto before = geometry::InspectMesh(mesh);
  SmoothMesh(mesh);
  const auto after = geometry::InspectMesh(mesh);
  EXPECT_NEAR(after.volume, before.volume, 1e-4 * before.volume);
  EXPECT_LT(after.area, 0.95 * before.area);
  EXPECT_TRUE(after.closed && after.manifold && after.outward);
}

TEST(SmoothMesh, KeepsABallsRadius) {
  auto mesh = geometry::MakeSphere({1, 2, 3}, 20, 4);
  SmoothMesh(mesh);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(Distance(p, {1, 2, 3}), 20, 0.05);
}

TEST(SetVolume, ReachesTheVolume) {
  auto mesh = geometry::MakeSphere({}, 1, 3);
  SetVolume(mesh, 4.4);
  EXPECT_NEAR(geometry::CalcVolume(mesh.positions, mesh.triangles), 4.4, 1e-5);
}

TEST(DecimateMesh, MeetsBudgetAndKeepsTopologyVolumeAndShape) {
  auto mesh = MakeBumpyTorus();
  SmoothMesh(mesh);
  const auto before = geometry::InspectMesh(mesh);
  for (const int budget : {400, 1000, 3001}) {
    const auto decimated = DecimateMesh(mesh, {.triangle_budget = budget});
    ASSERT_TRUE(decimated.ok()) << decimated.error().Text();
    const auto after = geometry::InspectMesh(*decimated);
    EXPECT_LE(after.triangles, static_cast<std::size_t>(budget));
    EXPECT_GE(static_cast<double>(after.triangles), 0.98 * budget);
    EXPECT_TRUE(after.closed && after.manifold && after.outward) << budget;
    EXPECT_EQ(after.genus, 1);
    EXPECT_NEAR(after.volume, before.volume, 0.005 * before.volume);
    EXPECT_GT(after.min_angle, 0.2) << budget;
    EXPECT_EQ(geometry::CountSelfIntersections(*decimated), 0u);
  }
}

TEST(DecimateMesh, RefusesAnOpenMesh) {
  auto mesh = geometry::MakeSphere({}, 1, 3);
  mesh.triangles.pop_back();
  const auto decimated = DecimateMesh(mesh, {.triangle_budget = 100});
  ASSERT_FALSE(decimated.ok());
  EXPECT_EQ(decimated.error().code, base::ErrorCode::kMeshNotClosed);
}

TEST(DecimateMesh, GivesTheSameBitsTwice) {
  auto mesh = MakeBumpyTorus();
  SmoothMesh(mesh);
  const auto first = DecimateMesh(mesh, {.triangle_budget = 500}),
             second = DecimateMesh(mesh, {.triangle_budget = 500});
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(*first, *second);
}

}  // namespace
}  // namespace trocar::meshing
