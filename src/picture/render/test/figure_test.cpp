// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/figure.h"

#include <gtest/gtest.h>

#include "trocar/geometry/primitives.h"

namespace trocar::render {
namespace {

using math::Vec3;

FigureSurface MakeBall(const Vec3& centre, double radius) {
  const auto mesh = geometry::MakeSphere(centre, radius, 3);
  return {mesh.triangles, mesh.positions, {{1, 0, 0}}};
}

TEST(PickSurface, FindsTheNearestSurfaceAndItsVertex) {
  const FigureSurface surfaces[] = {MakeBall({0, 0, 0}, 0.05), MakeBall({0, 0, 0.2}, 0.02)};
  const Ray ray{{0, 0, 1}, {0, 0, -1}};
  const auto hit = PickSurface(surfaces, ray);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->surface, 1u);
  EXPECT_NEAR(hit->point.z, 0.22, 2e-4);
  EXPECT_NEAR(hit->distance, 0.78, 2e-4);
  // the vertex is the triangle's corner nearest to the point
  const auto& surface = surfaces[1];
  for (const auto v : surface.triangles[hit->triangle])
    EXPECT_GE(Distance(surface.positions[v], hit->point) + 1e-15,
              Distance(surface.positions[hit->vertex], hit->point));
  EXPECT_FALSE(PickSurface(surfaces, {{0, 0.2, 1}, {0, 0, -1}}).has_value());
}

TEST(PickSurface, SeesNothingFromWithinAndPassesThroughWhatIsNotPickable) {
  FigureSurface surfaces[] = {MakeBall({0, 0, 0}, 0.05), MakeBall({0, 0, 0.2}, 0.02)};
  EXPECT_FALSE(PickSurface({surfaces, 1}, {{0, 0, 0}, {0, 0, 1}}).has_value());
  surfaces[1].is_pickable = false;
  const auto hit = PickSurface(surfaces, {{0, 0, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->surface, 0u);
}

TEST(PickPoint, TakesTheNearestWithinReach) {
  const FigureMarks marks{{}, {{{0, 0, 0}}, {{0.01, 0, 0}}, {{0, 0, 9}}}};
  const OrbitCamera camera = LookFrom(Viewpoint::kAnterior, {{-0.1, -0.1, 0}, {0.1, 0.1, 0}}, 1);
  const math::Vec2 second = CalcPixel(camera, {0.01, 0, 0}, 400, 400);
  EXPECT_EQ(PickPoint(marks.points, camera, second.x + 3, second.y, 400, 400), 1u);
  EXPECT_EQ(PickPoint(marks.points, camera, 200, 199, 400, 400), 0u);
  EXPECT_FALSE(PickPoint(marks.points, camera, 300, 300, 400, 400).has_value());
}

TEST(CalcFigureBox, HoldsEverythingAndIsNeverEmpty) {
  const FigureSurface surfaces[] = {MakeBall({0, 0, 0}, 0.05)};
  const auto box = CalcFigureBox(surfaces, {{{{{0, 0, 0}, {0.3, 0, 0}}}}, {{{0, -0.4, 0}}}});
  EXPECT_NEAR(box.max.x, 0.3, 1e-12);
  EXPECT_NEAR(box.min.y, -0.4, 1e-12);
  EXPECT_NEAR(box.max.z, 0.05, 1e-3);
  const auto empty = CalcFigureBox({});
  EXPECT_LT(empty.min.x, empty.max.x);
}

}  // namespace
}  // namespace trocar::render
