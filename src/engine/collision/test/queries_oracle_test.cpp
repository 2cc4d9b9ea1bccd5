// SPDX-License-Identifier: Apache-2.0
#include "random_triangles.h"
#include "trocar/collision/queries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "trocar/collision/brute_force.h"
#include "trocar/collision/triangle_distance.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::collision {

using math::Vec3;

namespace {

using geometry::TriangleMesh;

TriangleMesh MakeDentedBall() {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  for (Vec3& p : mesh.positions) p = (1.0 + 0.3 * std::sin(50 * p.x) * std::cos(40 * p.y)) * p;
  return mesh;
}

CentroidHierarchy MakeHierarchy(const TriangleMesh& mesh) {
  return CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
}

TEST(FindNearestToSegment, FindsWhatBruteForceFinds) {
  math::Random random(201);
  const TriangleMesh mesh = MakeDentedBall();
  const CentroidHierarchy hierarchy = MakeHierarchy(mesh);
  std::uint32_t guess = kNoTriangle;
  for (int trial = 0; trial < 600; ++trial) {
    const Vec3 start = RandomPoint(random, 0.25);
    const Vec3 end = trial % 9 == 0 ? start : start + RandomPoint(random, trial % 2 == 0 ? 0.4 : 0.02);
    const double limit = trial % 4 == 0 ? 0.02 : std::numeric_limits<double>::infinity();
    const SegmentContact oracle =
        FindNearestToSegmentBruteForce(mesh.positions, mesh.triangles, {start, end}, limit);
    const SegmentContact found =
        FindNearestToSegment(hierarchy, mesh.positions, {start, end}, {limit, guess});
    ASSERT_EQ(found.nearest.triangle, oracle.nearest.triangle) << "trial " << trial;
    EXPECT_EQ(found.nearest.squared_distance, oracle.nearest.squared_distance);
    EXPECT_EQ(found.parameter, oracle.parameter);
    guess = found.nearest.triangle;
  }
}

// Oracle of another kind: exact point searches at many places along the segment.
TEST(FindNearestToSegment, AgreesWithADenseSearchAlongTheShaft) {
  math::Random random(202);
  const TriangleMesh mesh = MakeDentedBall();
  const CentroidHierarchy hierarchy = MakeHierarchy(mesh);
  for (int trial = 0; trial < 60; ++trial) {
    const Segment shaft{RandomPoint(random, 0.3), RandomPoint(random, 0.2)};
    const double found =
        std::sqrt(FindNearestToSegment(hierarchy, mesh.positions, shaft).nearest.squared_distance);
    constexpr int kSteps = 1000;
    double best = 1e9;
    for (int i = 0; i <= kSteps; ++i) {
      const Vec3 p = shaft.start + (double(i) / kSteps) * (shaft.end - shaft.start);
      best = std::min(best, std::sqrt(hierarchy.FindNearest(mesh.positions, p).squared_distance));
    }
    EXPECT_LE(found, best + 1e-12);
    EXPECT_GE(found, best - 0.5 * math::Distance(shaft.start, shaft.end) / kSteps - 1e-12);
  }
}

// Analytic: a shaft that passes a box at 3 cm, a shaft through it, a tip 1 cm above its lid.
TEST(FindNearestToSegment, MeasuresABox) {
  const TriangleMesh box = geometry::MakeBox({0, 0, 0}, {0.1, 0.1, 0.1});
  const CentroidHierarchy hierarchy = MakeHierarchy(box);
  const auto distance = [&](Vec3 start, Vec3 end) {
    return std::sqrt(FindNearestToSegment(hierarchy, box.positions, {start, end}).nearest.squared_distance);
  };
  EXPECT_NEAR(distance({0.13, 0.05, -1}, {0.13, 0.05, 1}), 0.03, 1e-15);
  EXPECT_EQ(distance({0.03, 0.05, -1}, {0.03, 0.05, 1}), 0.0);
  EXPECT_NEAR(distance({0.02, 0.06, 0.5}, {0.02, 0.06, 0.11}), 0.01, 1e-15);
  EXPECT_NEAR(distance({0.15, -1, 0.15}, {0.15, 1, 0.15}), 0.05 * std::sqrt(2.0), 1e-15);
}

TEST(FindNearestToSegment, FindsNothingForSegmentsThatAreNotFinite) {
  const TriangleMesh box = geometry::MakeBox({0, 0, 0}, {0.1, 0.1, 0.1});
  const CentroidHierarchy hierarchy = MakeHierarchy(box);
  EXPECT_FALSE(FindNearestToSegment(hierarchy, box.positions, {{std::nan(""), 0, 0}, {1, 1, 1}}).Found());
  EXPECT_FALSE(FindNearestToSegment(CentroidHierarchy{}, {}, {{0, 0, 0}, {1, 1, 1}}).Found());
}

TEST(FindNearestToCapsule, SubtractsTheRadius) {
  const TriangleMesh box = geometry::MakeBox({0, 0, 0}, {0.1, 0.1, 0.1});
  const CentroidHierarchy hierarchy = MakeHierarchy(box);
  const Capsule apart{{{0.02, 0.06, 0.5}, {0.02, 0.06, 0.11}}, 0.0025};
  const CapsuleContact gap = FindNearestToCapsule(hierarchy, box.positions, apart);
  EXPECT_NEAR(gap.distance, 0.0075, 1e-15);
  EXPECT_NEAR(math::Distance(gap.on_capsule, {0.02, 0.06, 0.1075}), 0.0, 1e-15);
  const Capsule overlapping{{{0.02, 0.06, 0.5}, {0.02, 0.06, 0.101}}, 0.0025};
  EXPECT_NEAR(FindNearestToCapsule(hierarchy, box.positions, overlapping).distance, -0.0015, 1e-15);
  EXPECT_FALSE(FindNearestToCapsule(hierarchy, box.positions, apart, {.max_distance = 0.007}).Found());
  EXPECT_TRUE(FindNearestToCapsule(hierarchy, box.positions, apart, {.max_distance = 0.008}).Found());
}

TEST(FindTrianglesInCapsule, ListsWhatBruteForceLists) {
  math::Random random(203);
  const TriangleMesh mesh = MakeDentedBall();
  const CentroidHierarchy hierarchy = MakeHierarchy(mesh);
  std::size_t longest = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 start = RandomPoint(random, 0.13);
    const Capsule jaw{{start, start + RandomPoint(random, 0.03)}, random.Uniform(0, 0.02)};
    std::vector<std::uint32_t> oracle;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const geometry::Triangle& c = mesh.triangles[t];
      const double d2 = FindNearestSegmentTriangle(jaw.axis.start, jaw.axis.end, mesh.positions[c[0]],
                                                   mesh.positions[c[1]], mesh.positions[c[2]])
                            .squared_distance;
      if (d2 <= jaw.radius * jaw.radius) oracle.push_back(t);
    }
    std::vector<std::uint32_t> found(mesh.triangles.size());
    found.resize(FindTrianglesInCapsule(hierarchy, mesh.positions, jaw, found));
    EXPECT_EQ(found, oracle) << "trial " << trial;
    longest = std::max(longest, oracle.size());
    // a list that is too short is filled and the full number told
    std::uint32_t few[2];
    EXPECT_EQ(FindTrianglesInCapsule(hierarchy, mesh.positions, jaw, few), oracle.size());
  }
  EXPECT_GT(longest, 20u);
}

/// Winding number of a closed mesh about p: 1 inside, 0 outside (van Oosterom and Strackee 1983).
double CalcWindingNumber(const TriangleMesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - p, b = mesh.positions[t[1]] - p, c = mesh.positions[t[2]] - p;
    const double la = math::Norm(a), lb = math::Norm(b), lc = math::Norm(c);
    angle +=
        2.0 * std::atan2(math::Dot(a, math::Cross(b, c)),
                         la * lb * lc + math::Dot(a, b) * lc + math::Dot(b, c) * la + math::Dot(c, a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// Two thin walls that meet at a sharp angle: near its edges and corners a face's normal alone gives wrong
/// sides.
TriangleMesh MakeAngle() {
  TriangleMesh mesh;
  for (const double y : {-0.05, 0.05}) {
    mesh.positions.insert(mesh.positions.end(),
                          {{-0.05, y, -0.05}, {0.08, y, -0.05}, {-0.04, y, -0.04}, {-0.05, y, 0.08}});
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    mesh.triangles.push_back({i, i + 4, j + 4});
    mesh.triangles.push_back({i, j + 4, j});
  }
  return mesh;
}

TEST(FindSide, AgreesWithTheWindingNumber) {
  const geometry::MeshReport report = geometry::InspectMesh(MakeAngle());
  ASSERT_TRUE(report.closed && report.manifold && report.outward);

  math::Random random(204);
  int features[3] = {0, 0, 0}, inside = 0;
  for (const TriangleMesh& mesh : {MakeDentedBall(), geometry::MakeSphere({0.02, 0, 0}, 0.1, 1), MakeAngle(),
                                   geometry::MakeBox({-0.05, -0.1, -0.02}, {0.1, 0.1, 0.1})}) {
    const CentroidHierarchy hierarchy = MakeHierarchy(mesh);
    const geometry::Rows around = geometry::FindVertexTriangles(mesh.triangles, mesh.positions.size());
    for (int trial = 0; trial < 2000; ++trial) {
      Vec3 p = RandomPoint(random, 0.13);
      if (trial % 2 == 0)
        p = mesh.positions[random.NextWord() % mesh.positions.size()] + RandomPoint(random, 0.01);
      const NearestTriangle nearest = hierarchy.FindNearest(mesh.positions, p);
      if (nearest.squared_distance < 1e-18) continue;
      const SurfaceSide side = FindSide(mesh.positions, mesh.triangles, around, p, nearest);
      const bool is_inside = CalcWindingNumber(mesh, p) > 0.5;
      EXPECT_EQ(side.distance < 0, is_inside) << p.x << ", " << p.y << ", " << p.z;
      EXPECT_EQ(std::fabs(side.distance), std::sqrt(nearest.squared_distance));
      EXPECT_NEAR(math::Norm(side.normal), 1.0, 1e-12);
      ++features[static_cast<int>(side.feature)];
      inside += is_inside;
    }
  }
  for (const int count : features) EXPECT_GT(count, 100);
  EXPECT_GT(inside, 1000);
}

TEST(FindSide, GivesTheDiagonalAtACornerAndZeroOnTheSurface) {
  const TriangleMesh box = geometry::MakeBox({0, 0, 0}, {1, 1, 1});
  const CentroidHierarchy hierarchy = MakeHierarchy(box);
  const geometry::Rows around = geometry::FindVertexTriangles(box.triangles, box.positions.size());
  const auto side = [&](Vec3 p) {
    return FindSide(box.positions, box.triangles, around, p, hierarchy.FindNearest(box.positions, p));
  };
  const SurfaceSide corner = side({2, 2, 2});
  EXPECT_EQ(corner.feature, SurfaceFeature::kVertex);
  EXPECT_NEAR(math::Distance(corner.normal, math::Normalized(Vec3{1, 1, 1})), 0.0, 1e-12);
  EXPECT_NEAR(corner.distance, std::sqrt(3.0), 1e-12);
  const SurfaceSide edge = side({2, 2, 0.4});
  EXPECT_EQ(edge.feature, SurfaceFeature::kEdge);
  EXPECT_NEAR(math::Distance(edge.normal, math::Normalized(Vec3{1, 1, 0})), 0.0, 1e-12);
  EXPECT_NEAR(side({0.3, 0.4, 0.9}).distance, -0.1, 1e-15);
  EXPECT_NEAR(side({0.3, 0.4, 1.0}).distance, 0.0, 1e-15);
  EXPECT_EQ(side({1, 0, 1}).distance, 0.0);
}

TEST(IsInside, SaysWhatTheNearestFeatureSaysOfASoundSurface) {
  math::Random random(231);
  const TriangleMesh mesh = MakeDentedBall();
  const auto around = geometry::FindVertexTriangles(mesh.triangles, mesh.positions.size());
  const CentroidHierarchy hierarchy = MakeHierarchy(mesh);
  int inside = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    // every third point lies straight behind a vertex or an edge as a ray sees it
    Vec3 p = RandomPoint(random, 0.13);
    const auto& t = mesh.triangles[static_cast<std::size_t>(trial) % mesh.triangles.size()];
    if (trial % 3 == 0) p.x = mesh.positions[t[0]].x, p.y = mesh.positions[t[0]].y;
    if (trial % 3 == 1) p.z = mesh.positions[t[1]].z;
    const auto nearest = hierarchy.FindNearest(mesh.positions, p);
    const auto side = FindSide(mesh.positions, mesh.triangles, around, p, nearest);
    if (std::fabs(side.distance) < 1e-9) continue;
    ASSERT_EQ(IsInside(mesh.positions, mesh.triangles, p), side.distance < 0.0) << "trial " << trial;
    inside += side.distance < 0.0;
  }
  EXPECT_GT(inside, 300);
}

// A vertex drawn through its neighbours lays some triangles over others, face down.
TEST(IsInside, IsNotFooledByAFold) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  const auto top =
      static_cast<std::size_t>(std::max_element(mesh.positions.begin(), mesh.positions.end(),
                                                [](const Vec3& a, const Vec3& b) { return a.z < b.z; }) -
                               mesh.positions.begin());
  mesh.positions[top] += {0.04, 0, 0.006};
  for (double x = -0.02; x < 0.06; x += 0.0011) {
    const Vec3 above{x, 0.0007, 0.111}, below{x, 0.0007, 0.07};
    EXPECT_FALSE(IsInside(mesh.positions, mesh.triangles, above)) << x;
    EXPECT_TRUE(IsInside(mesh.positions, mesh.triangles, below)) << x;
  }
}

TEST(IsInside, HoldsWhereASurfaceHasAHoleOrFacesInwards) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  TriangleMesh inwards = mesh;
  for (auto& t : inwards.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(IsInside(inwards.positions, inwards.triangles, {0.001, 0.002, 0.003}));
  std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.positions[t[0]].x > 0.093; });
  EXPECT_TRUE(IsInside(mesh.positions, mesh.triangles, {0.001, 0.002, 0.003}));
  EXPECT_FALSE(IsInside(mesh.positions, mesh.triangles, {-0.12, 0.002, 0.003}));
  EXPECT_FALSE(IsInside(mesh.positions, {}, {0, 0, 0}));
}

}  // namespace
}  // namespace trocar::collision
