// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::meshing {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

void ExpectSameSurface(const TriangleMesh& before, const TriangleMesh& after, const std::string& what) {
  const auto old = geometry::InspectMesh(before), report = geometry::InspectMesh(after);
  EXPECT_TRUE(report.closed && report.manifold && report.outward) << what;
  EXPECT_EQ(report.genus, old.genus) << what;
  EXPECT_EQ(report.components, old.components) << what;
  EXPECT_LE(report.triangles, old.triangles) << what;
}

/// A lens: a sphere pressed flat.
TriangleMesh MakeLens(double thickness, int level = 3) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 1.0, level);
  for (Vec3& p : mesh.positions) p.z *= thickness;
  return mesh;
}

TEST(RepairMesh, LeavesAGoodMeshAlone) {
  TriangleMesh mesh = geometry::MakeSphere({1, 2, 3}, 20, 3);
  const TriangleMesh before = mesh;
  const RepairReport report = RepairMesh(mesh);
  EXPECT_EQ(mesh, before);
  EXPECT_EQ(report.flips + report.collapses + report.moves + report.slivers + report.self_intersections, 0u);
}

TEST(RepairMesh, TakesNeedlesAndCapsAway) {
  // each vertex of a few is moved almost onto a neighbour, or almost onto the opposite side of a triangle
  for (const bool is_needle : {true, false}) {
    TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 10, 3);
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 97) {
      const auto [a, b, c] = mesh.triangles[t];
      const Vec3 to = is_needle ? mesh.positions[b] : 0.5 * (mesh.positions[b] + mesh.positions[c]);
      mesh.positions[a] += 0.985 * (to - mesh.positions[a]);
    }
    const TriangleMesh before = mesh;
    ASSERT_LT(geometry::InspectMesh(mesh).min_angle, 3.0 * M_PI / 180);
    const RepairReport report = RepairMesh(mesh);
    EXPECT_EQ(report.slivers, 0u);
    EXPECT_GT(report.flips + report.collapses + report.moves, 0u);
    EXPECT_GE(geometry::InspectMesh(mesh).min_angle, 8.0 * M_PI / 180);
    ExpectSameSurface(before, mesh, is_needle ? "needles" : "caps");
    EXPECT_EQ(geometry::CountSelfIntersections(mesh), 0u);
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(Norm(p), 10, 0.5);
  }
}

TEST(RepairMesh, KeepsTheFewestTriangles) {
  TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 10, 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 97) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.positions[a] += 0.985 * (mesh.positions[b] - mesh.positions[a]);
  }
  RepairSettings settings;
  settings.fewest_triangles = mesh.triangles.size() - 4;
  const RepairReport report = RepairMesh(mesh, settings);
  EXPECT_LE(report.collapses, 2u);
  EXPECT_GE(mesh.triangles.size(), settings.fewest_triangles);
}

TEST(RepairMesh, PullsSheetsApartThatCutEachOther) {
  TriangleMesh mesh = MakeLens(0.08);
  // some vertices of the upper sheet are pushed through the lower one
  int pushed = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); v += 23) {
    Vec3& p = mesh.positions[v];
    if (p.z > 0.02 && std::hypot(p.x, p.y) < 0.9) p.z = -1.3 * p.z, ++pushed;
  }
  ASSERT_GE(pushed, 4);
  const TriangleMesh before = mesh;
  ASSERT_GT(geometry::CountSelfIntersections(mesh), 10u);
  const RepairReport report = RepairMesh(mesh, {.min_angle_deg = 3.0});
  EXPECT_EQ(report.self_intersections, 0u);
  EXPECT_EQ(geometry::CountSelfIntersections(mesh), 0u);
  ExpectSameSurface(before, mesh, "lens");
}

// Property: whatever the input, topology stays and no defect is added.
TEST(RepairMesh, NeverMakesAMeshWorse) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    math::Random random(seed);
    TriangleMesh mesh = MakeLens(random.Uniform(0.02, 0.3), 2);
    for (Vec3& p : mesh.positions)
      p += 0.04 * Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const TriangleMesh before = mesh;
    const auto cuts = geometry::CountSelfIntersections(mesh);
    const RepairReport report = RepairMesh(mesh);
    const std::string what = "seed " + std::to_string(seed);
    EXPECT_EQ(report.self_intersections, geometry::CountSelfIntersections(mesh)) << what;
    EXPECT_LE(report.self_intersections, cuts) << what;
    if (geometry::InspectMesh(before).outward) ExpectSameSurface(before, mesh, what);
    TriangleMesh again = before;
    RepairMesh(again);
    EXPECT_EQ(again, mesh) << what;
  }
}

}  // namespace
}  // namespace trocar::meshing
