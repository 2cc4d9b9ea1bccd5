// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/centroid_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "trocar/collision/brute_force.h"
#include "trocar/geometry/primitives.h"

namespace trocar::collision {

using math::Vec3;

namespace {

using geometry::TriangleMesh;

/// One small triangle about each centre.
TriangleMesh TrianglesAt(std::span<const Vec3> centres, double size = 1e-3) {
  TriangleMesh mesh;
  for (const Vec3& centre : centres) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(centre + Vec3{size, 0, 0});
    mesh.positions.push_back(centre + Vec3{-size, size, 0});
    mesh.positions.push_back(centre + Vec3{0, -size, 0});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

CentroidHierarchy MakeChecked(const TriangleMesh& mesh) {
  base::Result<CentroidHierarchy> made = CentroidHierarchy::Make(mesh.positions, mesh.triangles);
  EXPECT_TRUE(made.ok());
  return std::move(made).value();
}

/// Triangles below a node, ascending.
std::vector<std::uint32_t> GroupOf(const CentroidHierarchy& hierarchy, std::uint32_t node) {
  std::vector<std::uint32_t> group, open{node};
  while (!open.empty()) {
    const HierarchyNode& at = hierarchy.Nodes()[open.back()];
    open.pop_back();
    if (at.IsLeaf()) {
      group.push_back(at.triangle_k);
    } else {
      open.push_back(at.first_child), open.push_back(at.first_child + 1);
    }
  }
  std::sort(group.begin(), group.end());
  return group;
}

void ExpectSoundTree(const CentroidHierarchy& hierarchy) {
  const auto nodes = hierarchy.Nodes();
  ASSERT_EQ(nodes.size(), 2 * hierarchy.Triangles().size() - 1);
  std::vector<int> seen(hierarchy.Triangles().size(), 0);
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].IsLeaf()) {
      ++seen[nodes[i].triangle_k];
      continue;
    }
    EXPECT_GT(nodes[i].first_child, i) << "parents come first";
    EXPECT_EQ(nodes[nodes[i].first_child].parent, i);
    EXPECT_EQ(nodes[nodes[i].first_child + 1].parent, i);
  }
  for (const int count : seen) ASSERT_EQ(count, 1) << "each triangle has one leaf";
  EXPECT_LE(hierarchy.Depth(), kMaxHierarchyDepth);
}

// The paper's rule, checked in every node: the representatives are the farthest pair, and each other centroid
// went to U_k exactly where d(C_j, C_i) > d(C_k, C_i).
TEST(CentroidHierarchy, SplitsEveryGroupAsThePaperSays) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.05, 3);
  for (Vec3& p : mesh.positions) p = {1.7 * p.x, p.y, p.z + 4.0 * p.x * p.x};
  const CentroidHierarchy hierarchy = MakeChecked(mesh);
  ExpectSoundTree(hierarchy);
  ASSERT_LT(hierarchy.Depth(), kMaxFarthestPairDepth);
  const auto centroids = hierarchy.Centroids();
  for (std::uint32_t i = 0; i < hierarchy.Nodes().size(); ++i) {
    const HierarchyNode& node = hierarchy.Nodes()[i];
    if (node.IsLeaf()) continue;
    const FarthestPair pair = FindFarthestPairBruteForce(centroids, GroupOf(hierarchy, i));
    ASSERT_EQ(node.triangle_k, pair.first);
    ASSERT_EQ(node.triangle_j, pair.second);
    for (const std::uint32_t t : GroupOf(hierarchy, node.first_child)) {
      EXPECT_TRUE(t == node.triangle_k ||
                  math::SquaredDistance(centroids[node.triangle_j], centroids[t]) >
                      math::SquaredDistance(centroids[node.triangle_k], centroids[t]));
    }
    for (const std::uint32_t t : GroupOf(hierarchy, node.first_child + 1)) {
      EXPECT_LE(math::SquaredDistance(centroids[node.triangle_j], centroids[t]),
                math::SquaredDistance(centroids[node.triangle_k], centroids[t]));
    }
  }
}

// By hand: five triangles in a row at 0, 1, 5, 9, 10 cm; the middle one is as far from either end and goes to
// U_j.
TEST(CentroidHierarchy, GivesAnEquallyFarCentroidToGroupJ) {
  const Vec3 centres[] = {{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {9, 0, 0}, {10, 0, 0}};
  const CentroidHierarchy hierarchy = MakeChecked(TrianglesAt(centres, 0.25));
  EXPECT_EQ(GroupOf(hierarchy, 1), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(GroupOf(hierarchy, 2), (std::vector<std::uint32_t>{2, 3, 4}));
  EXPECT_EQ(hierarchy.FindGreedy({1.2, 0, 0}), 1u);
  EXPECT_EQ(hierarchy.FindGreedy({8.6, 0, 0}), 3u);
}

// The greedy descent cannot turn back: here it takes the wrong group, and the exact search does not.
TEST(CentroidHierarchy, GreedySearchMissesWhatTheExactSearchFinds) {
  const Vec3 centres[] = {{0, 0, 0}, {4.8, 0, 0}, {10, 0, 0}};
  const TriangleMesh mesh = TrianglesAt(centres, 0.01);
  const CentroidHierarchy hierarchy = MakeChecked(mesh);
  const Vec3 p{5.1, 0, 0};
  EXPECT_EQ(hierarchy.FindGreedy(p), 2u);
  EXPECT_EQ(hierarchy.FindNearest(mesh.positions, p).triangle, 1u);
}

TEST(CentroidHierarchy, StaysBoundedOnBadShapes) {
  constexpr int kCount = 3000;
  std::vector<Vec3> equal(kCount, Vec3{0.1, 0.1, 0.1}), line, powers, spiral;
  for (int i = 0; i < kCount; ++i) {
    line.push_back({0.001 * i, 0, 0});
    // each point as far from the next as all before it together: the farthest-pair split takes off one at a
    // time
    powers.push_back({std::pow(2.0, i % 500), 0, 0});
    spiral.push_back({std::pow(1.5, i % 700) * std::cos(i), std::pow(1.5, i % 700) * std::sin(i), 0});
  }
  for (const std::vector<Vec3>& centres : {equal, line, powers, spiral}) {
    const TriangleMesh mesh = TrianglesAt(centres);
    const CentroidHierarchy hierarchy = MakeChecked(mesh);
    ExpectSoundTree(hierarchy);
    for (const Vec3& p : {Vec3{0.1, 0.1, 0.2}, Vec3{1e5, 3, 1}, Vec3{-4, 0, 0}}) {
      const NearestTriangle exact = hierarchy.FindNearest(mesh.positions, p);
      EXPECT_EQ(exact.triangle, FindNearestBruteForce(mesh.positions, mesh.triangles, p).triangle);
      EXPECT_LT(hierarchy.FindGreedy(p), mesh.triangles.size());
    }
  }
  EXPECT_LE(MakeChecked(TrianglesAt(equal)).Depth(), 12);
  EXPECT_GT(MakeChecked(TrianglesAt(powers)).Depth(), kMaxFarthestPairDepth);
}

TEST(CentroidHierarchy, ServesOneTriangleAndNone) {
  const Vec3 centre[] = {{0, 0, 0}};
  const TriangleMesh one = TrianglesAt(centre);
  CentroidHierarchy hierarchy = MakeChecked(one);
  EXPECT_EQ(hierarchy.Depth(), 0);
  EXPECT_EQ(hierarchy.FindGreedy({1, 2, 3}), 0u);
  EXPECT_EQ(hierarchy.FindNearest(one.positions, {1, 2, 3}).triangle, 0u);
  const std::uint32_t modified[] = {0, 0};
  hierarchy.Update(one.positions, modified);
  EXPECT_EQ(hierarchy.FindNearest(one.positions, {0, 0, 1}).squared_distance, 1.0);
  CentroidHierarchy empty;
  empty.UpdateAll({});
  empty.Update({}, {});
  EXPECT_EQ(empty.FindGreedy({0, 0, 0}), kNoTriangle);
  EXPECT_FALSE(empty.FindNearest({}, {0, 0, 0}).Found());
}

TEST(CentroidHierarchy, RefusesBadMeshes) {
  TriangleMesh mesh = geometry::MakeBox({0, 0, 0}, {1, 1, 1});
  const auto code = [](const TriangleMesh& bad) {
    const auto made = CentroidHierarchy::Make(bad.positions, bad.triangles);
    return made.ok() ? base::ErrorCode::kNone : made.error().code;
  };
  EXPECT_EQ(code(mesh), base::ErrorCode::kNone);
  EXPECT_EQ(code({}), base::ErrorCode::kMeshInvalid);
  TriangleMesh out_of_range = mesh;
  out_of_range.triangles[3][1] = 8;
  EXPECT_EQ(code(out_of_range), base::ErrorCode::kMeshInvalid);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TriangleMesh not_finite = mesh;
    not_finite.positions[2].y = bad;
    EXPECT_EQ(code(not_finite), base::ErrorCode::kMeshInvalid);
  }
}

TEST(CentroidHierarchy, FindsNothingForAPointThatIsNotFinite) {
  const TriangleMesh mesh = geometry::MakeBox({0, 0, 0}, {1, 1, 1});
  const CentroidHierarchy hierarchy = MakeChecked(mesh);
  EXPECT_FALSE(hierarchy.FindNearest(mesh.positions, {std::nan(""), 0, 0}).Found());
  EXPECT_FALSE(
      hierarchy.FindNearest(mesh.positions, {0, std::numeric_limits<double>::infinity(), 0}).Found());
}

TEST(CentroidHierarchy, KeepsToTheMaximumDistance) {
  const TriangleMesh mesh = geometry::MakeBox({0, 0, 0}, {1, 1, 1});
  const CentroidHierarchy hierarchy = MakeChecked(mesh);
  EXPECT_FALSE(hierarchy.FindNearest(mesh.positions, {0.3, 0.2, 3}, {.max_distance = 1.999}).Found());
  const NearestTriangle touching =
      hierarchy.FindNearest(mesh.positions, {0.3, 0.2, 3}, {.max_distance = 2.0});
  ASSERT_TRUE(touching.Found());
  EXPECT_EQ(touching.squared_distance, 4.0);
  EXPECT_FALSE(hierarchy.FindNearest(mesh.positions, {0.3, 0.2, 1}, {.max_distance = -1.0}).Found());
  EXPECT_TRUE(hierarchy.FindNearest(mesh.positions, {1, 1, 1}, {.max_distance = 0.0}).Found());
}

// On a vertex all its triangles are equally near; the answer is the first of them, whichever the tree visits
// first.
TEST(CentroidHierarchy, AnswersTiesWithTheLowestIndex) {
  TriangleMesh mesh = geometry::MakeSphere({0.3, 0.1, 0.2}, 0.1, 2);
  std::reverse(mesh.triangles.begin() + 100, mesh.triangles.end());
  const CentroidHierarchy hierarchy = MakeChecked(mesh);
  for (std::uint32_t vertex = 0; vertex < mesh.positions.size(); ++vertex) {
    std::uint32_t lowest = 0;
    while (std::count(mesh.triangles[lowest].begin(), mesh.triangles[lowest].end(), vertex) == 0) ++lowest;
    EXPECT_EQ(hierarchy.FindNearest(mesh.positions, mesh.positions[vertex]).triangle, lowest);
    EXPECT_EQ(FindNearestBruteForce(mesh.positions, mesh.triangles, mesh.positions[vertex]).triangle, lowest);
  }
}

// A mesh with a NaN is the solver's fault to report; the search must still end, with some sound triangle or
// none.
TEST(CentroidHierarchy, SurvivesPositionsThatBecomeNotFinite) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 1.0, 2);
  CentroidHierarchy hierarchy = MakeChecked(mesh);
  mesh.positions[0] = {std::nan(""), std::nan(""), std::nan("")};
  hierarchy.UpdateAll(mesh.positions);
  const NearestTriangle nearest = hierarchy.FindNearest(mesh.positions, {2, 0, 0});
  EXPECT_TRUE(!nearest.Found() || std::isfinite(nearest.squared_distance));
  EXPECT_LT(hierarchy.FindGreedy({2, 0, 0}), mesh.triangles.size());
}

}  // namespace
}  // namespace trocar::collision
