// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_slice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "trocar/geometry/primitives.h"

namespace trocar::meshing {
namespace {

TEST(CutMesh, SphereGivesACircle) {
  const auto ball = geometry::MakeSphere({30, 30, 0}, 20, 5);
  const auto loops = JoinLoops(CutMesh(ball, 12));
  ASSERT_EQ(loops.size(), 1u);
  for (const auto& p : loops[0]) EXPECT_NEAR(std::hypot(p.x - 30, p.y - 30), 16, 0.05);
  EXPECT_NEAR(std::fabs(CalcPolygonArea(loops[0])), M_PI * 256, 2);
  EXPECT_TRUE(JoinLoops(CutMesh(ball, 21)).empty());
}

TEST(CutMesh, PlaneThroughVerticesStillClosesEveryLoop) {
  // the box's corners and many of the sphere's vertices lie in the plane
  const auto box = geometry::MakeBox({1, 1, 0}, {5, 4, 2});
  for (const double height : {0.0, 1.0, 2.0}) {
    for (const auto& loop : JoinLoops(CutMesh(box, height)))
      EXPECT_NEAR(std::fabs(CalcPolygonArea(loop)), 12, 1e-12);
  }
  const auto ball = geometry::MakeSphere({0, 0, 0}, 1, 3);
  const auto equator = JoinLoops(CutMesh(ball, 0));
  ASSERT_EQ(equator.size(), 1u);
  EXPECT_NEAR(std::fabs(CalcPolygonArea(equator[0])), M_PI, 0.05);
}

TEST(JoinLoops, KeepsTwoBodiesApart) {
  auto mesh = geometry::MakeSphere({0, 0, 0}, 1, 2);
  const auto other = geometry::MakeSphere({5, 0, 0}, 0.5, 2);
  const auto shift = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  EXPECT_EQ(JoinLoops(CutMesh(mesh, 0.1)).size(), 2u);
}

TEST(CalcCoverage, SumsToTheAreaAndIsPartialAtTheBorderOnly) {
  const auto ball = geometry::MakeSphere({10.3, 9.8, 0}, 6, 5);
  const auto cut = CutMesh(ball, 0.01);
  const SliceGrid grid{41, 39, 0.5};
  const auto coverage = CalcCoverage(cut, grid, 4);
  const double area = 0.25 * std::accumulate(coverage.begin(), coverage.end(), 0.0);
  EXPECT_NEAR(area, M_PI * 36, 0.4);
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      const double away = std::hypot(0.5 * i - 10.3, 0.5 * j - 9.8) - 6;
      const float here = coverage[static_cast<std::size_t>(j) * grid.width + i];
      if (away < -0.4) {
        EXPECT_FLOAT_EQ(here, 1);
      }
      if (away > 0.4) {
        EXPECT_EQ(here, 0);
      }
    }
  }
}

TEST(CalcCoverage, CutsAtTheBorderOfTheGrid) {
  const auto box = geometry::MakeBox({-3, -3, -1}, {2, 50, 1});
  const auto coverage = CalcCoverage(CutMesh(box, 0), {4, 3, 1}, 1);
  EXPECT_EQ(coverage, (std::vector<float>{1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0}));
}

}  // namespace
}  // namespace trocar::meshing
