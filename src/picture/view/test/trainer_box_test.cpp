// SPDX-License-Identifier: Apache-2.0
#include "trainer_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::view {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

TEST(TrainerBox, AFacedBoxHasSharpEdgesAndItsFacesAreDividedAsAsked) {
  const Vec3 min{-0.03, -0.02, 0.01}, max{0.05, 0.04, 0.02};
  // out of order, twice, and outside
  const Divisions divisions{std::vector{0.02, 0.0, 0.02, 0.9}, {0.01}, {}};
  for (const auto faces : {DividedFaces::kAll, DividedFaces::kTop}) {
    const TriangleMesh box = MakeFacedBox(min, max, divisions, faces);
    EXPECT_NEAR(geometry::CalcVolume(box.positions, box.triangles), 0.08 * 0.06 * 0.01, 1e-12);
    std::vector<Vec3> normals(box.positions.size());
    geometry::CalcVertexNormals(box.positions, box.triangles, normals);
    const Vec3 middle = 0.5 * (min + max);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const Vec3& n = normals[i];
      ASSERT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0, 1e-12) << "along an axis";
      ASSERT_GT(math::Dot(n, box.positions[i] - middle), 0.0) << "outwards";
    }
    // quads: 3 x 2 on top and below, 3 and 2 on two sides each
    const std::size_t quads = faces == DividedFaces::kAll ? 2 * (3 * 2 + 3 + 2) : 3 * 2 + 5;
    EXPECT_EQ(box.triangles.size(), 2 * quads);
  }
}

TEST(TrainerBox, ABoardIsDividedAtTheFeetOfWhatStandsOnIt) {
  const Vec3 half{0.08, 0.06, 0.005};
  const math::Pose X_world_board{{}, {0.01, 0.02, -0.10}};
  const auto post_at = [](double bottom) {
    return MakeFacedBox({0.027, 0.017, bottom}, {0.033, 0.023, bottom + 0.03});
  };
  const auto lines_along_x = [&](const TriangleMesh& still) {
    const std::vector all{still};
    std::vector<double> lines;
    for (const Vec3& p : MakeBoard(half, X_world_board, all).positions) lines.push_back(p.x);
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    return lines;
  };
  const std::vector<double> standing = lines_along_x(post_at(-0.095)), above = lines_along_x(post_at(-0.04));
  for (const double foot : {0.017, 0.023}) {
    const auto is_there = [foot](double x) { return std::abs(x - foot) < 1e-9; };
    EXPECT_TRUE(std::ranges::any_of(standing, is_there)) << foot;
    EXPECT_FALSE(std::ranges::any_of(above, is_there)) << foot;
  }
  for (std::size_t i = 0; i + 1 < above.size(); ++i) EXPECT_LT(above[i + 1] - above[i], 0.0401);
}

TEST(TrainerBox, ABoardIsFlatAndLargerThanWhatHandsMove) {
  rigid::RigidShape shape;
  shape.size = {0.085, 0.065, 0.005};
  EXPECT_TRUE(IsBoard(shape));
  shape.size = {0.005, 0.085, 0.065};
  EXPECT_FALSE(IsBoard(shape)) << "a wall";
  shape.size = {0.085, 0.010, 0.005};
  EXPECT_FALSE(IsBoard(shape)) << "a bar";
  shape.size = {0.085, 0.065, 0.005};
  shape.kind = rigid::RigidShape::Kind::kRing;
  EXPECT_FALSE(IsBoard(shape));
}

// A board with a post on its middle, in a box.
TEST(TrainerBox, CornersAndTheFootOfAPostLieLessOpen) {
  TriangleMesh walls = MakeFacedBox({-0.15, -0.15, -0.01}, {0.15, 0.15, 0.15},
                                    {std::vector{-0.14, 0.0, 0.14}, {-0.14, 0.0, 0.14}, {0.0, 0.07}});
  for (auto& t : walls.triangles) std::swap(t[1], t[2]);
  const TriangleMesh post = MakeFacedBox({-0.003, -0.003, 0}, {0.003, 0.003, 0.03});
  std::vector still{walls, post};
  still.push_back(MakeBoard({0.08, 0.08, 0.005}, {{}, {0, 0, -0.005}}, still));
  for (Vec3& p : still.back().positions) p.z -= 0.005;
  const std::vector<std::vector<double>> open = CalcTrainerOpenness(still);
  const auto at = [&](std::size_t which, const Vec3& place) {
    const TriangleMesh& mesh = still[which];
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      if (math::Distance(mesh.positions[i], place) < math::Distance(mesh.positions[nearest], place))
        nearest = i;
    }
    return open[which][nearest];
  };
  const double foot = at(2, {0.008, 0, 0}), free = at(2, {0.04, 0.04, 0});
  EXPECT_LT(foot, free - 0.1);
  EXPECT_GT(free, 0.8);
  EXPECT_LT(at(0, {-0.15, -0.14, 0.0}), at(0, {-0.15, 0, 0.07}) - 0.15) << "corner and wall";
  for (const std::vector<double>& of_mesh : open) {
    for (const double value : of_mesh) {
      ASSERT_GE(value, 0.0);
      ASSERT_LE(value, 1.0);
    }
  }
}

}  // namespace
}  // namespace trocar::view
