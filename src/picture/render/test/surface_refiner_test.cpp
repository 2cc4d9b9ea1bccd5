// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/surface_refiner.h"

#include <gtest/gtest.h>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"

namespace trocar::render {
namespace {

using math::Vec3;

geometry::TriangleMesh Refine(const geometry::TriangleMesh& coarse, const std::vector<Vec3>& normals) {
  const SurfaceRefiner refiner(coarse.triangles, coarse.positions.size());
  geometry::TriangleMesh fine{std::vector<Vec3>(refiner.VertexCount()), {}};
  std::vector<Vec3> fine_normals(refiner.VertexCount());
  refiner.Refine(coarse.positions, normals, fine.positions, fine_normals);
  fine.triangles.assign(refiner.Triangles().begin(), refiner.Triangles().end());
  for (const Vec3& n : fine_normals) EXPECT_NEAR(math::Norm(n), 1.0, 1e-12);
  return fine;
}

// Analytic: on a ball with true normals the new vertices come close to the ball, chords would not.
TEST(SurfaceRefiner, RoundsABall) {
  const auto coarse = geometry::MakeSphere({0, 0, 0}, 1.0, 2);
  const auto fine = Refine(coarse, coarse.positions);
  const auto report = geometry::InspectMesh(fine);
  EXPECT_TRUE(report.closed && report.manifold && report.outward);
  EXPECT_EQ(fine.triangles.size(), 4 * coarse.triangles.size());
  for (const Vec3& p : fine.positions) EXPECT_NEAR(math::Norm(p), 1.0, 1e-3);
}

TEST(SurfaceRefiner, LeavesAPlaneFlatAndItsBoundaryStraight) {
  const auto coarse = geometry::MakeGrid(4, 0.5);
  const auto fine = Refine(coarse, std::vector<Vec3>(coarse.positions.size(), {0, 0, 1}));
  for (const Vec3& p : fine.positions) EXPECT_DOUBLE_EQ(p.z, 0.0);
  EXPECT_DOUBLE_EQ(geometry::CalcArea(fine.positions, fine.triangles),
                   geometry::CalcArea(coarse.positions, coarse.triangles));
}

}  // namespace
}  // namespace trocar::render
