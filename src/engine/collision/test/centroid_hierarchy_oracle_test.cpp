// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "random_triangles.h"
#include "trocar/collision/brute_force.h"
#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::collision {

using geometry::Box;
using math::Vec3;

namespace {

using geometry::TriangleMesh;

/// A body like a liver: a sphere, flattened, bent and dented.
TriangleMesh MakeLiverLike(int subdivisions) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, subdivisions);
  for (Vec3& p : mesh.positions) {
    p = {1.2 * p.x, 0.8 * p.y, 0.45 * p.z + 3.0 * p.x * p.x - 0.02 * std::sin(40 * p.y)};
  }
  return mesh;
}

void ExpectSameAsBruteForce(const CentroidHierarchy& hierarchy, const TriangleMesh& mesh, const Vec3& p,
                            const SearchLimits& limits = {}) {
  const NearestTriangle oracle =
      FindNearestBruteForce(mesh.positions, mesh.triangles, p, limits.max_distance);
  const NearestTriangle found = hierarchy.FindNearest(mesh.positions, p, limits);
  ASSERT_EQ(found.triangle, oracle.triangle) << "p = " << p.x << ", " << p.y << ", " << p.z;
  EXPECT_EQ(found.squared_distance, oracle.squared_distance);
  EXPECT_EQ(found.point, oracle.point);
  EXPECT_EQ(found.weights, oracle.weights);
}

/// Points near, inside and far, and on vertices, edges and faces.
std::vector<Vec3> MakeQueries(const TriangleMesh& mesh, math::Random& random, int count) {
  std::vector<Vec3> queries;
  for (int i = 0; i < count; ++i) {
    const geometry::Triangle& t = mesh.triangles[random.NextWord() % mesh.triangles.size()];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    switch (i % 6) {
      case 0:
        queries.push_back(RandomPoint(random, 0.15));
        break;
      case 1:
        queries.push_back(a);
        break;
      case 2:
        queries.push_back(math::Lerp(b, c, random.Uniform()));
        break;
      case 3:
        queries.push_back((a + b + c) / 3.0);
        break;
      case 4:
        queries.push_back(math::Lerp(a, b, random.Uniform()) + RandomPoint(random, 1e-4));
        break;
      default:
        queries.push_back(RandomPoint(random, 20.0));
        break;
    }
  }
  return queries;
}

TEST(CentroidHierarchyOracle, FindsWhatBruteForceFinds) {
  math::Random random(101);
  std::vector<TriangleMesh> meshes{
      MakeLiverLike(3),          geometry::MakeGrid(20, 0.005), geometry::MakeBox({0, 0, 0}, {.1, .1, .1}),
      MakeSoup(random, 1, 0.01), MakeSoup(random, 2, 0.01),     MakeSoup(random, 700, 0.01),
      MakeSoup(random, 300, 0.2)};
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    SCOPED_TRACE("mesh " + std::to_string(m));
    const CentroidHierarchy hierarchy =
        CentroidHierarchy::Make(meshes[m].positions, meshes[m].triangles).value();
    for (const Vec3& p : MakeQueries(meshes[m], random, 600)) {
      ExpectSameAsBruteForce(hierarchy, meshes[m], p);
      if (HasFatalFailure()) return;
    }
  }
}

// Slivers, coinciding triangles and a fan around one point, all far from the origin, where rounding is worst.
TEST(CentroidHierarchyOracle, FindsWhatBruteForceFindsOnBadMeshes) {
  math::Random random(102);
  TriangleMesh slivers, copies, fan;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const Vec3 a = RandomPoint(random, 0.1), b = RandomPoint(random, 0.1);
    const double height = std::pow(10.0, random.Uniform(-20, -4));
    for (const Vec3& p : {a, b, math::Lerp(a, b, random.Uniform()) + RandomPoint(random, height)})
      slivers.positions.push_back(p);
    slivers.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  copies = MakeSoup(random, 8, 0.05);
  for (int i = 0; i < 300; ++i) copies.triangles.push_back(copies.triangles[random.NextWord() % 8]);
  fan.positions.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < 300; ++i) {
    fan.positions.push_back({0.1 * std::cos(i * 0.0209), 0.1 * std::sin(i * 0.0209), 0.01 * (i % 3)});
    fan.triangles.push_back({0, i + 1, (i + 1) % 300 + 1});
  }
  for (TriangleMesh* mesh : {&slivers, &copies, &fan}) {
    for (const double shift : {0.0, 1000.0}) {
      for (Vec3& p : mesh->positions) p += Vec3{shift, -shift, 0.3 * shift};
      const CentroidHierarchy hierarchy = CentroidHierarchy::Make(mesh->positions, mesh->triangles).value();
      for (const Vec3& p : MakeQueries(*mesh, random, 600)) {
        ExpectSameAsBruteForce(hierarchy, *mesh, p);
        if (HasFatalFailure()) return;
      }
    }
  }
}

// In a plane that is no round number an interpolated point may lie a bit outside of its triangle's box. Boxes
// that are cut to the corners lose such triangles.
TEST(CentroidHierarchyOracle, FindsWhatBruteForceFindsInAPlane) {
  math::Random random(106);
  for (const double height : {1.0 / 3.0, 0.1, 0.7, 1e3 / 7.0}) {
    TriangleMesh mesh = geometry::MakeGrid(12, 0.1);
    for (Vec3& p : mesh.positions) p.z = height;
    const CentroidHierarchy hierarchy = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
    for (int trial = 0; trial < 3000; ++trial) {
      const geometry::Triangle& t = mesh.triangles[random.NextWord() % mesh.triangles.size()];
      const Vec3 on_side = math::Lerp(mesh.positions[t[1]], mesh.positions[t[2]], random.Uniform());
      ExpectSameAsBruteForce(hierarchy, mesh, on_side + Vec3{0, 0, random.Uniform(-0.2, 0.2)});
      if (HasFatalFailure()) return;
    }
  }
}

TEST(CentroidHierarchyOracle, FirstGuessAndLimitDoNotChangeTheAnswer) {
  math::Random random(103);
  const TriangleMesh mesh = MakeLiverLike(3);
  const CentroidHierarchy hierarchy = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
  for (const Vec3& p : MakeQueries(mesh, random, 900)) {
    const auto guess = static_cast<std::uint32_t>(random.NextWord() % (mesh.triangles.size() + 2));
    ExpectSameAsBruteForce(hierarchy, mesh, p, {.first_guess = guess});
    ExpectSameAsBruteForce(hierarchy, mesh, p, {.max_distance = 0.01, .first_guess = guess});
    if (HasFatalFailure()) return;
  }
}

void Deform(TriangleMesh& mesh, math::Random& random) {
  const Vec3 centre = mesh.positions[random.NextWord() % mesh.positions.size()];
  const Vec3 pull = RandomPoint(random, 0.04);
  for (Vec3& p : mesh.positions) p += std::exp(-math::SquaredDistance(p, centre) / 0.002) * pull;
}

bool SameBoxes(const CentroidHierarchy& a, const CentroidHierarchy& b) {
  return std::equal(a.Boxes().begin(), a.Boxes().end(), b.Boxes().begin(), b.Boxes().end(),
                    [](const Box& x, const Box& y) { return x.min == y.min && x.max == y.max; }) &&
         std::equal(a.Centroids().begin(), a.Centroids().end(), b.Centroids().begin(), b.Centroids().end());
}

// Every box holds its triangles and touches them: the oracle for a refit, computed top-down by brute force.
void ExpectTightBoxes(const CentroidHierarchy& hierarchy, const TriangleMesh& mesh) {
  const auto nodes = hierarchy.Nodes();
  std::vector<Box> boxes(nodes.size(), Box{{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}});
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].IsLeaf()) continue;
    for (std::uint32_t node = i;; node = nodes[node].parent) {
      for (const std::uint32_t v : mesh.triangles[nodes[i].triangle_k]) {
        boxes[node].min = math::Min(boxes[node].min, mesh.positions[v]);
        boxes[node].max = math::Max(boxes[node].max, mesh.positions[v]);
      }
      if (node == 0) break;
    }
  }
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const Box& box = hierarchy.Boxes()[i];
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(box.min[axis], boxes[i].min[axis]);
      ASSERT_GE(box.max[axis], boxes[i].max[axis]);
      ASSERT_NEAR(box.min[axis], boxes[i].min[axis], 1e-14);
      ASSERT_NEAR(box.max[axis], boxes[i].max[axis], 1e-14);
    }
  }
}

TEST(CentroidHierarchyOracle, UpdatesFollowADeformingMesh) {
  math::Random random(104);
  TriangleMesh mesh = MakeLiverLike(3);
  CentroidHierarchy all = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value(), listed = all;
  std::vector<std::uint32_t> modified;
  for (int tick = 0; tick < 12; ++tick) {
    const std::vector<Vec3> before = mesh.positions;
    Deform(mesh, random);
    // only what moved by more than a micrometre; the rest is put back
    modified.clear();
    for (std::size_t v = 0; v < before.size(); ++v) {
      if (math::Distance(before[v], mesh.positions[v]) < 1e-6) mesh.positions[v] = before[v];
    }
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const geometry::Triangle& corners = mesh.triangles[t];
      if (std::any_of(corners.begin(), corners.end(),
                      [&](std::uint32_t v) { return mesh.positions[v] != before[v]; })) {
        modified.push_back(t);
        if (t % 5 == 0) modified.push_back(t);
      }
    }
    ASSERT_FALSE(modified.empty());
    all.UpdateAll(mesh.positions);
    listed.Update(mesh.positions, modified);
    ASSERT_TRUE(SameBoxes(all, listed)) << "tick " << tick;
    ExpectTightBoxes(listed, mesh);
    for (const Vec3& p : MakeQueries(mesh, random, 200)) {
      ExpectSameAsBruteForce(listed, mesh, p);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(CentroidHierarchyOracle, GreedySearchIsRepeatableAndItsMissesAreReported) {
  math::Random random(105);
  const TriangleMesh mesh = MakeLiverLike(4);
  const CentroidHierarchy hierarchy = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
  const CentroidHierarchy again = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
  ASSERT_TRUE(SameBoxes(hierarchy, again));
  int same_centroid = 0, same_triangle = 0;
  constexpr int kQueries = 500;
  for (int i = 0; i < kQueries; ++i) {
    const Vec3 p =
        hierarchy.Centroids()[random.NextWord() % mesh.triangles.size()] + RandomPoint(random, 0.005);
    const std::uint32_t greedy = hierarchy.FindGreedy(p);
    ASSERT_LT(greedy, mesh.triangles.size());
    EXPECT_EQ(greedy, again.FindGreedy(p));
    same_centroid += greedy == FindNearestCentroidBruteForce(hierarchy.Centroids(), p);
    same_triangle += greedy == FindNearestBruteForce(mesh.positions, mesh.triangles, p).triangle;
  }
  RecordProperty("greedy_finds_nearest_centroid_percent", 100 * same_centroid / kQueries);
  RecordProperty("greedy_finds_nearest_triangle_percent", 100 * same_triangle / kQueries);
}

}  // namespace
}  // namespace trocar::collision
