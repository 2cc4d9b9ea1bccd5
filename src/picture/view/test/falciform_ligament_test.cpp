// SPDX-License-Identifier: Apache-2.0
#include "falciform_ligament.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"

namespace trocar::view {
namespace {

using math::Vec3;

TEST(FalciformLigament, IsAClosedSheetFromTheLiverToTheWall) {
  geometry::TriangleMesh wall = geometry::MakeSphere({0, 0, 0}, 0.2, 4);
  std::vector<Vec3> attachment;
  for (int i = 0; i < 30; ++i) attachment.push_back({0.001 * (i % 3), 0.002 * i, 0.1 + 0.001 * i});
  const auto sheet = MakeFalciformLigament(attachment, wall);
  const auto report = geometry::InspectMesh(sheet);
  EXPECT_TRUE(report.closed && report.manifold);
  EXPECT_GT(report.volume, 0.0) << "outward";
  const auto by_height = [](const Vec3& a, const Vec3& b) { return a.z < b.z; };
  const auto [low, high] = std::minmax_element(sheet.positions.begin(), sheet.positions.end(), by_height);
  EXPECT_LT(low->z, 0.105) << "at the liver";
  EXPECT_GT(high->z, 0.19) << "at the wall";
  const auto first = *std::min_element(sheet.positions.begin(), sheet.positions.end(),
                                       [](const Vec3& a, const Vec3& b) { return a.y < b.y; });
  EXPECT_LT(first.y, -0.01) << "a free edge before the liver's";
  EXPECT_EQ(MakeFalciformLigament(attachment, wall), sheet);
}

TEST(FalciformLigament, IsNotThereWithoutAPlaceToLeaveTheLiver) {
  const auto wall = geometry::MakeSphere({0, 0, 0}, 0.2, 3);
  EXPECT_TRUE(MakeFalciformLigament({}, wall).triangles.empty());
  const std::vector<Vec3> outside(5, Vec3{0.5, 0.5, 0});
  EXPECT_TRUE(MakeFalciformLigament(outside, wall).triangles.empty());
}

}  // namespace
}  // namespace trocar::view
