// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/ambient_occlusion.h"

#include <gtest/gtest.h>

#include "trocar/geometry/primitives.h"

namespace trocar::render {
namespace {

using math::Vec3;

TEST(CalcAmbientOcclusion, IsOneOnAFreePlaneAndLowerUnderALid) {
  const auto floor = geometry::MakeBox({-0.1, -0.1, -0.001}, {0.1, 0.1, 0});
  const auto lid = geometry::MakeBox({-0.02, -0.02, 0.012}, {0.02, 0.02, 0.014});
  const std::vector<Vec3> points{{0, 0, 0}, {0.08, 0, 0}};
  const std::vector<Vec3> normals{{0, 0, 1}, {0, 0, 1}};
  const geometry::TriangleMesh* const occluders[] = {&floor, &lid};
  const auto open = CalcAmbientOcclusion(std::span(occluders).first(1), points, normals, 0.03);
  EXPECT_DOUBLE_EQ(open[0], 1.0);
  EXPECT_DOUBLE_EQ(open[1], 1.0);
  const auto covered = CalcAmbientOcclusion(occluders, points, normals, 0.03);
  EXPECT_LT(covered[0], 0.5);
  EXPECT_DOUBLE_EQ(covered[1], 1.0);
}

TEST(CalcAmbientOcclusion, FallsAsTheLidComesNearer) {
  const std::vector<Vec3> points{{0, 0, 0}}, normals{{0, 0, 1}};
  double before = 0.0;
  for (const double height : {0.010, 0.016, 0.022, 0.028, 0.05}) {
    const auto lid = geometry::MakeBox({-0.05, -0.05, height}, {0.05, 0.05, height + 0.002});
    const geometry::TriangleMesh* const occluders[] = {&lid};
    const double now = CalcAmbientOcclusion(occluders, points, normals, 0.03)[0];
    EXPECT_GT(now, before) << height;
    before = now;
  }
  EXPECT_DOUBLE_EQ(before, 1.0);
}

TEST(CalcAmbientOcclusion, WithoutOccludersEverythingIsOpen) {
  const std::vector<Vec3> points{{1, 2, 3}}, normals{{0, 1, 0}};
  EXPECT_DOUBLE_EQ(CalcAmbientOcclusion({}, points, normals, 0.03)[0], 1.0);
}

}  // namespace
}  // namespace trocar::render
