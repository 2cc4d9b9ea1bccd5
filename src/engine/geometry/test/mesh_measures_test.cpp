// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/mesh_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/geometry/distance.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

TEST(CalcVolume, OfAFineSphereApproachesTheFormula) {
  const TriangleMesh sphere = MakeSphere({0.3, -0.2, 0.1}, 0.05, 5);
  const double exact = 4.0 / 3.0 * M_PI * std::pow(0.05, 3);
  EXPECT_NEAR(CalcVolume(sphere.positions, sphere.triangles) / exact, 1.0, 1e-3);
  EXPECT_NEAR(CalcArea(sphere.positions, sphere.triangles) / (4 * M_PI * 0.05 * 0.05), 1.0, 1e-3);
}

TEST(InspectMesh, FindsASphereClosedManifoldOutwardOfGenusZero) {
  const MeshReport report = InspectMesh(MakeSphere({0, 0, 0}, 1, 2));
  EXPECT_EQ(report.triangles, 320u);
  EXPECT_TRUE(report.closed && report.manifold && report.outward);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.components, 1u);
}

TEST(InspectMesh, SeesEachDefect) {
  TriangleMesh open = MakeSphere({0, 0, 0}, 1, 1);
  open.triangles.pop_back();
  EXPECT_FALSE(InspectMesh(open).closed);

  TriangleMesh inside_out = MakeSphere({0, 0, 0}, 1, 1);
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_FALSE(InspectMesh(inside_out).outward);
  EXPECT_TRUE(InspectMesh(inside_out).manifold);

  TriangleMesh one_flipped = MakeSphere({0, 0, 0}, 1, 1);
  std::swap(one_flipped.triangles[3][0], one_flipped.triangles[3][1]);
  EXPECT_EQ(InspectMesh(one_flipped).odd_edges, 3u);

  // two tetrahedra that touch in one vertex
  const TriangleMesh bow{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}}};
  EXPECT_EQ(InspectMesh(bow).odd_vertices, 1u);
  EXPECT_FALSE(InspectMesh(bow).manifold);
}

TEST(InspectMesh, CountsTheHandleOfATorus) {
  constexpr std::uint32_t kN = 12;
  TriangleMesh torus;
  for (std::uint32_t i = 0; i < kN; ++i) {
    for (std::uint32_t j = 0; j < kN; ++j) {
      const double u = 2 * M_PI * i / kN, v = 2 * M_PI * j / kN;
      torus.positions.push_back(
          {(2 + std::cos(v)) * std::cos(u), (2 + std::cos(v)) * std::sin(u), std::sin(v)});
      const auto at = [](std::uint32_t a, std::uint32_t b) { return (a % kN) * kN + b % kN; };
      torus.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const MeshReport report = InspectMesh(torus);
  EXPECT_TRUE(report.closed && report.manifold && report.outward);
  EXPECT_EQ(report.genus, 1);
}

// Oracle: all pairs, with needles across the whole mesh that the grid does not hold.
TEST(FindSelfIntersections, FindsWhatAllPairsFind) {
  TriangleMesh mesh = MakeSphere({0, 0, 0}, 1.0, 2);
  const auto add = [&mesh](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto n = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.push_back({n, n + 1, n + 2});
  };
  add({-40, -41, -42}, {40, 41, 42}, {40, 41, 42.0001});
  add({-2, 0.1, 0.2}, {2, 0.1, 0.2}, {2, 0.1003, 0.2});
  add({-9, -9, 0.05}, {9, -9, 0.05}, {0, 9, 0.05});
  std::vector<std::array<std::uint32_t, 2>> expected;
  for (std::uint32_t a = 0; a < mesh.triangles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < mesh.triangles.size(); ++b) {
      Vec3 p[3], q[3];
      for (int i = 0; i < 3; ++i)
        p[i] = mesh.positions[mesh.triangles[a][i]], q[i] = mesh.positions[mesh.triangles[b][i]];
      if (TrianglesCut(mesh.triangles[a], p, mesh.triangles[b], q)) expected.push_back({a, b});
    }
  }
  EXPECT_GT(expected.size(), 20u);
  EXPECT_EQ(FindSelfIntersections(mesh), expected);
}

TEST(TrianglesCut, SeesWhatHappensBeyondACommonCorner) {
  const Vec3 a[3] = {{0, 0, 0}, {4, -2, 0}, {4, 2, 0}};
  const Vec3 through[3] = {{0, 0, 0}, {3, 0, -1}, {3, 0, 1}},
             beside[3] = {{0, 0, 0}, {-3, 0, -1}, {-3, 0, 1}};
  const Vec3 above[3] = {{0, 0, 0}, {3, 0, 1}, {3, 1, 1}}, in_plane[3] = {{0, 0, 0}, {0, 3, 0}, {-3, 3, 0}};
  const Triangle one = {0, 1, 2}, other = {0, 3, 4}, turned = {4, 0, 3};
  EXPECT_TRUE(TrianglesCut(one, a, other, through));
  EXPECT_TRUE(TrianglesCut(other, through, one, a));
  const Vec3 turned_through[3] = {through[2], through[0], through[1]};
  EXPECT_TRUE(TrianglesCut(one, a, turned, turned_through));
  for (const auto* corners : {beside, above, in_plane}) EXPECT_FALSE(TrianglesCut(one, a, other, corners));
  // the same two triangles without a common vertex touch
  EXPECT_TRUE(TrianglesCut(one, a, {5, 3, 4}, beside));
  // neighbours along an edge never cut, however folded
  EXPECT_FALSE(TrianglesCut(one, a, {1, 0, 3}, a));
}

TEST(FindSelfIntersections, FindsAFanThatPassesThroughItself) {
  const TriangleMesh fan{{{0, 0, 0}, {4, -2, 0}, {4, 2, 0}, {3, 0, -1}, {3, 0, 1}, {-3, 0, 0}},
                         {{0, 1, 2}, {0, 3, 4}, {0, 4, 5}}};
  const std::vector<std::array<std::uint32_t, 2>> expected = {{0, 1}};
  EXPECT_EQ(FindSelfIntersections(fan), expected);
}

TEST(FindVertexNeighbours, HasEveryNeighbourOnceInOrder) {
  const Rows rows = FindVertexNeighbours(MakeBox({0, 0, 0}, {1, 1, 1}).triangles, 9);
  ASSERT_EQ(rows.Count(), 9u);
  std::size_t sum = 0;
  for (std::size_t v = 0; v < 8; ++v) {
    const auto row = rows.Row(v);
    EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
    EXPECT_EQ(std::adjacent_find(row.begin(), row.end()), row.end());
    sum += row.size();
  }
  EXPECT_EQ(sum, 2u * 18u);
  EXPECT_TRUE(rows.Row(8).empty());
}

TEST(CountSelfIntersections, IsZeroForASphereAndPositiveForTwoThatOverlap) {
  TriangleMesh mesh = MakeSphere({0, 0, 0}, 1, 2);
  EXPECT_EQ(CountSelfIntersections(mesh), 0u);
  const TriangleMesh other = MakeSphere({1, 0.1, 0.2}, 1, 2);
  const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  EXPECT_GT(CountSelfIntersections(mesh), 10u);
}

TEST(FindEdges, OfTheTable1GridsFollowEuler) {
  for (const int n : {16, 112}) {
    const TriangleMesh grid = MakeGrid(n, 0.001);
    EXPECT_EQ(grid.triangles.size(), 2u * (n - 1) * (n - 1));
    EXPECT_EQ(FindEdges(grid.triangles).size(), grid.positions.size() + grid.triangles.size() - 1);
  }
}

TEST(CalcVertexNormals, OfASpherePointOutwards) {
  const TriangleMesh sphere = MakeSphere({1, 2, 3}, 0.5, 3);
  std::vector<Vec3> normals(sphere.positions.size());
  CalcVertexNormals(sphere.positions, sphere.triangles, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_GT(math::Dot(normals[i], (sphere.positions[i] - Vec3{1, 2, 3}) / 0.5), 0.999);
  }
}

TEST(CheckMesh, RefusesBadIndexAndNan) {
  TriangleMesh mesh = MakeBox({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(CheckMesh(mesh).ok());
  EXPECT_TRUE(InspectMesh(mesh).closed && InspectMesh(mesh).manifold && InspectMesh(mesh).outward);
  mesh.triangles[5][1] = 8;
  EXPECT_EQ(CheckMesh(mesh).error().code, base::ErrorCode::kMeshInvalid);
  mesh.triangles[5][1] = 1;
  mesh.positions[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(CheckMesh(mesh).error().code, base::ErrorCode::kMeshInvalid);
}

}  // namespace
}  // namespace trocar::geometry
