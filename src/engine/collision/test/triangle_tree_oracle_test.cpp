// SPDX-License-Identifier: Apache-2.0
/// \file triangle_tree_oracle_test.cpp  The running search against brute force, to the bit, on every instruction
/// set that this processor has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "random_triangles.h"
#include "trocar/collision/brute_force.h"
#include "trocar/collision/triangle_distance.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::collision {

using math::Vec3;

namespace {

using base::SimdLevel;
using geometry::TriangleMesh;

std::vector<SimdLevel> Levels() {
  std::vector<SimdLevel> levels;
  for (const auto level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (base::HasSimdLevel(level)) levels.push_back(level);
  }
  return levels;
}

/// Needles, triangles without area, points and copies of all of them.
TriangleMesh MakeDegenerate(math::Random& random, int count) {
  TriangleMesh mesh = MakeSoup(random, count, 0.02);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    switch (i % 6) {
      case 0:
        r = math::Lerp(p, q, 0.4) + RandomPoint(random, 1e-9);
        break;
      case 1:
        r = math::Lerp(p, q, 0.4);
        break;
      case 2:
        q = r = p;
        break;
      case 3:
        q = p + RandomPoint(random, 1e-13);
        break;
      default:
        break;
    }
  }
  const std::size_t half = mesh.triangles.size() / 2;
  for (std::size_t i = 0; i < half; ++i) mesh.triangles.push_back(mesh.triangles[i]);
  return mesh;
}

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

std::vector<NamedMesh> AdversarialMeshes() {
  math::Random random(77);
  std::vector<NamedMesh> meshes;
  meshes.push_back({"one triangle", MakeSoup(random, 1, 0.1)});
  meshes.push_back({"eight triangles", MakeSoup(random, 8, 0.1)});
  meshes.push_back({"nine triangles", MakeSoup(random, 9, 0.1)});
  meshes.push_back({"ball", geometry::MakeSphere({0, 0, 0}, 0.1, 3)});
  meshes.push_back({"soup", MakeSoup(random, 700, 0.03)});
  meshes.push_back({"degenerate", MakeDegenerate(random, 300)});
  TriangleMesh copies = MakeSoup(random, 1, 0.05);
  for (int i = 0; i < 100; ++i) copies.triangles.push_back(copies.triangles[0]);
  meshes.push_back({"101 copies", copies});
  for (const double far : {1e3, 1e6, 1e12}) {
    TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 2);
    for (Vec3& p : mesh.positions) p += Vec3{far, -far, 0.3 * far};
    meshes.push_back({"far " + std::to_string(far), mesh});
  }
  for (const double scale : {1e-30, 1e-20, 1e-9, 1e9, 1e14}) {
    TriangleMesh mesh = MakeSoup(random, 200, 0.05);
    for (Vec3& p : mesh.positions) p = scale * p;
    meshes.push_back({"scale " + std::to_string(scale), mesh});
  }
  TriangleMesh flat = MakeSoup(random, 300, 0.05);
  for (Vec3& p : flat.positions) p.z = 0;
  meshes.push_back({"flat", flat});
  TriangleMesh mixed = MakeSoup(random, 300, 0.01);
  for (std::size_t i = 0; i < mixed.positions.size(); i += 7) mixed.positions[i] = 1e4 * mixed.positions[i];
  meshes.push_back({"huge among small", mixed});
  return meshes;
}

/// Size and middle of a mesh, so that queries meet it.
std::vector<Vec3> MakePoints(const TriangleMesh& mesh, math::Random& random, int count) {
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) low = math::Min(low, p), high = math::Max(high, p);
  const Vec3 middle = 0.5 * (low + high);
  const double size = math::Distance(low, high);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const auto& [a, b, c] = mesh.triangles[random.NextWord() % mesh.triangles.size()];
    switch (i % 5) {
      case 0:
        points.push_back(middle + RandomPoint(random, size));
        break;
      case 1:
        points.push_back(mesh.positions[a]);
        break;
      case 2:
        points.push_back((mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3.0);
        break;
      case 3:
        points.push_back(0.5 * (mesh.positions[b] + mesh.positions[c]) + RandomPoint(random, 1e-3 * size));
        break;
      default:
        points.push_back(middle + RandomPoint(random, 20 * size));
    }
  }
  return points;
}

void ExpectSame(const NearestTriangle& found, const NearestTriangle& oracle, const std::string& where) {
  ASSERT_EQ(found.triangle, oracle.triangle) << where;
  EXPECT_EQ(found.squared_distance, oracle.squared_distance) << where;
  EXPECT_EQ(found.point, oracle.point) << where;
  EXPECT_EQ(found.weights, oracle.weights) << where;
}

TEST(TriangleTree, FindsWhatBruteForceFinds) {
  math::Random random(5);
  for (const auto& [name, mesh] : AdversarialMeshes()) {
    const std::vector<Vec3> points = MakePoints(mesh, random, 120);
    for (const SimdLevel level : Levels()) {
      const auto tree = TriangleTree::Make(mesh.positions, mesh.triangles, level);
      ASSERT_TRUE(tree.ok()) << name;
      SearchLimits limits;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string where = name + ", " + std::string(SimdLevelName(level)) + ", " + std::to_string(i);
        const NearestTriangle oracle = FindNearestBruteForce(mesh.positions, mesh.triangles, points[i]);
        ExpectSame(tree->FindNearest(mesh.positions, points[i]), oracle, where);
        // a guess changes nothing; a limit hides only what is farther
        limits.max_distance = std::sqrt(oracle.squared_distance) * (i % 2 == 0 ? 1.5 : 0.99);
        const NearestTriangle limited =
            FindNearestBruteForce(mesh.positions, mesh.triangles, points[i], limits.max_distance);
        ExpectSame(tree->FindNearest(mesh.positions, points[i], limits), limited, where + ", limited");
        limits.first_guess = oracle.triangle;
      }
    }
  }
}

TEST(TriangleTree, FindsTheNearestToASegmentAsBruteForceDoes) {
  math::Random random(6);
  for (const auto& [name, mesh] : AdversarialMeshes()) {
    const std::vector<Vec3> starts = MakePoints(mesh, random, 60), ends = MakePoints(mesh, random, 60);
    for (const SimdLevel level : Levels()) {
      const auto tree = TriangleTree::Make(mesh.positions, mesh.triangles, level);
      ASSERT_TRUE(tree.ok()) << name;
      for (std::size_t i = 0; i < starts.size(); ++i) {
        const std::string where = name + ", " + std::string(SimdLevelName(level)) + ", " + std::to_string(i);
        const Vec3 end = i % 10 == 9 ? starts[i] : ends[i];
        const SegmentContact oracle =
            FindNearestToSegmentBruteForce(mesh.positions, mesh.triangles, {starts[i], end});
        const SegmentContact found = tree->FindNearestToSegment(mesh.positions, {starts[i], end});
        ExpectSame(found.nearest, oracle.nearest, where);
        EXPECT_EQ(found.parameter, oracle.parameter) << where;
        EXPECT_EQ(found.on_segment, oracle.on_segment) << where;
      }
    }
  }
}

TEST(TriangleTree, FindsEveryTriangleWithinACapsule) {
  math::Random random(7);
  for (const auto& [name, mesh] : AdversarialMeshes()) {
    const std::vector<Vec3> starts = MakePoints(mesh, random, 30), ends = MakePoints(mesh, random, 30);
    for (const SimdLevel level : Levels()) {
      const auto tree = TriangleTree::Make(mesh.positions, mesh.triangles, level);
      ASSERT_TRUE(tree.ok()) << name;
      for (std::size_t i = 0; i < starts.size(); ++i) {
        const Vec3 end = i % 3 == 0 ? starts[i] : ends[i];
        std::vector<double> distances;
        for (const auto& [a, b, c] : mesh.triangles) {
          distances.push_back(FindNearestSegmentTriangle(starts[i], end, mesh.positions[a], mesh.positions[b],
                                                         mesh.positions[c])
                                  .squared_distance);
        }
        // a third of the triangles: the radius is exactly one triangle's distance or just above
        std::vector<double> sorted = distances;
        std::sort(sorted.begin(), sorted.end());
        const double radius = std::sqrt(sorted[sorted.size() / 3]) * (1 + 1e-15);
        std::vector<std::uint32_t> oracle;
        for (std::uint32_t t = 0; t < distances.size(); ++t) {
          if (distances[t] <= radius * radius) oracle.push_back(t);
        }
        std::vector<std::uint32_t> found(mesh.triangles.size());
        found.resize(tree->FindWithin(mesh.positions, {{starts[i], end}, radius}, found));
        EXPECT_EQ(found, oracle) << name << ", " << SimdLevelName(level) << ", " << i;
      }
    }
  }
}

TEST(TriangleTree, SaysWhatIsInsideAsALookAtEveryTriangleDoes) {
  math::Random random(9);
  int inside = 0, outside = 0;
  for (const auto& [name, mesh] : AdversarialMeshes()) {
    std::vector<Vec3> points = MakePoints(mesh, random, 200);
    // straight before or behind a vertex, as a ray sees it
    for (std::size_t i = 0; i < points.size(); i += 3) {
      const Vec3& vertex = mesh.positions[i % mesh.positions.size()];
      points[i].x = vertex.x, points[i].y = vertex.y;
    }
    for (const SimdLevel level : Levels()) {
      const auto tree = TriangleTree::Make(mesh.positions, mesh.triangles, level);
      ASSERT_TRUE(tree.ok()) << name;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const bool expected = IsInside(mesh.positions, mesh.triangles, points[i]);
        EXPECT_EQ(tree->IsInside(mesh.positions, points[i]), expected)
            << name << ", " << SimdLevelName(level) << ", " << i;
        ++(expected ? inside : outside);
      }
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_GT(outside, 300);
  EXPECT_FALSE(TriangleTree().IsInside({}, {0, 0, 0}));
}

// The tree is built once; its boxes follow wherever the vertices go.
TEST(TriangleTree, StaysExactWhileTheMeshDeforms) {
  math::Random random(8);
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  const std::vector<Vec3> rest = mesh.positions;
  for (const SimdLevel level : Levels()) {
    auto tree = TriangleTree::Make(rest, mesh.triangles, level);
    ASSERT_TRUE(tree.ok());
    for (int tick = 0; tick < 12; ++tick) {
      for (std::size_t i = 0; i < rest.size(); ++i) {
        // turned inside out and shaken, at last
        mesh.positions[i] = (1.0 - 0.2 * tick) * rest[i] + RandomPoint(random, 0.004 * tick);
      }
      tree->Update(mesh.positions);
      for (int i = 0; i < 20; ++i) {
        const Vec3 p = RandomPoint(random, 0.2), q = RandomPoint(random, 0.2);
        const std::string where = std::to_string(tick) + ", " + std::to_string(i);
        EXPECT_EQ(tree->IsInside(mesh.positions, p), IsInside(mesh.positions, mesh.triangles, p)) << where;
        ExpectSame(tree->FindNearest(mesh.positions, p),
                   FindNearestBruteForce(mesh.positions, mesh.triangles, p), where);
        ExpectSame(tree->FindNearestToSegment(mesh.positions, {p, q}).nearest,
                   FindNearestToSegmentBruteForce(mesh.positions, mesh.triangles, {p, q}).nearest, where);
      }
    }
  }
}

// Negative control: without the update the tree would answer for where the mesh was.
TEST(TriangleTree, MissesWhatMovedWithoutAnUpdate) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  auto tree = TriangleTree::Make(mesh.positions, mesh.triangles);
  ASSERT_TRUE(tree.ok());
  for (Vec3& p : mesh.positions) p += Vec3{1, 0, 0};
  const SearchLimits near{.max_distance = 0.05};
  EXPECT_FALSE(tree->FindNearest(mesh.positions, {1.12, 0, 0}, near).Found());
  tree->Update(mesh.positions);
  EXPECT_TRUE(tree->FindNearest(mesh.positions, {1.12, 0, 0}, near).Found());
}

TEST(TriangleTree, RebuildsForAnotherTopology) {
  math::Random random(9);
  const TriangleMesh first = geometry::MakeSphere({0, 0, 0}, 0.1, 3), second = MakeSoup(random, 300, 0.02);
  auto tree = TriangleTree::Make(first.positions, first.triangles);
  ASSERT_TRUE(tree.ok());
  ASSERT_TRUE(tree->Rebuild(second.positions, second.triangles).ok());
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = RandomPoint(random, 0.2);
    ExpectSame(tree->FindNearest(second.positions, p),
               FindNearestBruteForce(second.positions, second.triangles, p), std::to_string(i));
  }
}

TEST(TriangleTree, CapsuleDistanceIsTheAxisDistanceLessTheRadius) {
  const TriangleMesh box = geometry::MakeBox({0, 0, 0}, {0.1, 0.1, 0.1});
  const auto tree = TriangleTree::Make(box.positions, box.triangles);
  ASSERT_TRUE(tree.ok());
  const CapsuleContact above =
      tree->FindNearestToCapsule(box.positions, {{{0.02, 0.05, 0.13}, {0.08, 0.05, 0.13}}, 0.01});
  ASSERT_TRUE(above.Found());
  EXPECT_NEAR(above.distance, 0.02, 1e-15);
  EXPECT_FALSE(tree->FindNearestToCapsule(box.positions, {{{0.02, 0.05, 0.13}, {0.08, 0.05, 0.13}}, 0.01},
                                          {.max_distance = 0.019})
                   .Found());
}

TEST(TriangleTree, RefusesBadMeshesAndQueries) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 1);
  EXPECT_EQ(TriangleTree::Make(mesh.positions, {}).error().code, base::ErrorCode::kMeshInvalid);
  const std::vector<geometry::Triangle> outside{{0, 1, 99999}};
  EXPECT_EQ(TriangleTree::Make(mesh.positions, outside).error().code, base::ErrorCode::kMeshInvalid);
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), 1e16}) {
    TriangleMesh broken = mesh;
    broken.positions[3].y = bad;
    EXPECT_EQ(TriangleTree::Make(broken.positions, broken.triangles).error().code,
              base::ErrorCode::kMeshInvalid);
  }
  const auto tree = TriangleTree::Make(mesh.positions, mesh.triangles);
  ASSERT_TRUE(tree.ok());
  EXPECT_FALSE(tree->FindNearest(mesh.positions, {nan, 0, 0}).Found());
  EXPECT_FALSE(tree->FindNearestToSegment(mesh.positions, {{0, 0, 0}, {0, nan, 0}}).Found());
  EXPECT_FALSE(tree->FindNearest(mesh.positions, {0, 0, 0}, {.max_distance = -1}).Found());
  std::uint32_t found[4];
  EXPECT_EQ(tree->FindWithin(mesh.positions, {{{0, 0, 0}, {0, 0, 0}}, nan}, found), 0u);
  EXPECT_TRUE(tree->FindNearest(mesh.positions, {1e200, 0, 0}).triangle == kNoTriangle ||
              std::isfinite(tree->FindNearest(mesh.positions, {1e100, 0, 0}).squared_distance));
  EXPECT_FALSE(TriangleTree().FindNearest({}, {0, 0, 0}).Found());
}

}  // namespace
}  // namespace trocar::collision
