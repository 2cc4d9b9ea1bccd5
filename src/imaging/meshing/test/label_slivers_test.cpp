// SPDX-License-Identifier: Apache-2.0
// No triangle below 5 degrees from label maps at their worst (harsh_labels.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "harsh_labels.h"
#include "sliver_removal.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/meshing/label_volume.h"
#include "trocar/meshing/volume_mesher.h"

namespace trocar::meshing {
namespace {

using test::LabelFaults;

constexpr double kLeastAngle = 5.0 * M_PI / 180;

MeshedVolume Mesh(const LabelFaults& faults, const MeshingSettings& settings) {
  const images::LabelVolume map = test::MakeHarshLabels(faults);
  const auto& voxel = faults.voxel_mm;
  const auto count = static_cast<double>(std::count(map.labels.begin(), map.labels.end(), 1));
  auto volume = MakeLabelVolume(FillLabelSlices(map, 1, voxel, voxel[0]), voxel[0],
                                count * voxel[0] * voxel[1] * voxel[2]);
  EXPECT_TRUE(volume.ok()) << faults.name;
  if (!volume.ok()) return {};
  auto meshed = MeshVolume(std::move(*volume), settings);
  EXPECT_TRUE(meshed.ok()) << faults.name;
  return meshed.ok() ? std::move(*meshed) : MeshedVolume{};
}

void ExpectNoSliver(const LabelFaults& faults) {
  MeshingSettings settings;
  settings.distance_samples = 0;
  const MeshedVolume meshed = Mesh(faults, settings);
  const geometry::MeshReport& surface = meshed.quality.surface;
  EXPECT_TRUE(meshed.quality.IsSound())
      << faults.name << ": " << meshed.quality.self_intersections << " cuts";
  EXPECT_GE(surface.min_angle, kLeastAngle) << faults.name;
  EXPECT_EQ(surface.components, 1u) << faults.name;
  EXPECT_LE(surface.triangles, static_cast<std::size_t>(settings.triangle_budget)) << faults.name;
  EXPECT_GE(static_cast<double>(surface.triangles), 0.98 * settings.triangle_budget) << faults.name;
  EXPECT_LT(std::fabs(meshed.quality.volume_change), 0.005) << faults.name;
}

/// The kinds of trouble one by one, then together as random label maps have them.
std::vector<LabelFaults> MakeCases() {
  std::vector<LabelFaults> cases = {
      {.name = "1 x 1 x 3 mm", .voxel_mm = {1, 1, 3}},
      {.name = "3 mm", .voxel_mm = {3, 3, 3}},
      {.name = "oblique", .voxel_mm = {1.5, 1.5, 3}, .tilt_rad = 0.3},
      {.name = "cut off by the field of view", .voxel_mm = {1.5, 1.5, 3}, .cut_above_mm = 20},
      {.name = "thin sheets", .voxel_mm = {2, 2, 2}, .sheets = 3},
      {.name = "noise of a voxel", .voxel_mm = {3, 3, 3}, .noise = 0.5},
      {.name = "stairs of four slices", .repeated_slices = 4},
  };
  return cases;
}

/// As in the slow test; several of them keep slivers without the removal.
LabelFaults MakeRandomFaults(std::uint64_t seed) {
  constexpr std::array<std::array<double, 3>, 6> kVoxels = {
      {{1, 1, 3}, {3, 3, 3}, {2, 2, 5}, {1.5, 1.5, 3}, {2.5, 2.5, 2.5}, {4, 4, 4}}};
  LabelFaults faults;
  faults.name = "seed " + std::to_string(seed);
  faults.seed = seed;
  faults.voxel_mm = kVoxels[seed % 6];
  const auto mode = seed % 4, strength = seed % 3;
  faults.vessel_generations = mode == 3 ? 0 : mode == 0 ? 3 : 4;
  faults.sheets = mode % 2 == 1 ? 3 : 0;
  faults.lumps = mode >= 2 ? 10 : 0;
  faults.repeated_slices = strength == 2 ? 2 : 1;
  faults.noise = 0.3 * static_cast<double>(strength);
  if (mode == 1) faults.cut_above_mm = 20;
  faults.tilt_rad = 0.15 * static_cast<double>(strength);
  return faults;
}

TEST(MeshLabels, LeavesNoSliverInHarshMaps) {
  for (const LabelFaults& faults : MakeCases()) ExpectNoSliver(faults);
}

TEST(MeshLabels, LeavesNoSliverWhereRepairAloneDoes) {
  const LabelFaults faults = MakeRandomFaults(5);
  MeshingSettings without;
  without.distance_samples = 0;
  without.sliver_angle_deg = 0;
  EXPECT_LT(Mesh(faults, without).quality.surface.min_angle, kLeastAngle)
      << "the map does not test the removal";
  ExpectNoSliver(faults);
}

TEST(MeshLabelsSlow, LeaveNoSliverInRandomMaps) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) ExpectNoSliver(MakeRandomFaults(seed));
}

TEST(RemoveSlivers, LeavesAMeshWithoutSliversAlone) {
  geometry::TriangleMesh mesh = geometry::MakeSphere({1, 2, 3}, 20, 3);
  const geometry::TriangleMesh before = mesh;
  EXPECT_EQ(RemoveSlivers(mesh), 0u);
  EXPECT_EQ(mesh, before);
}

TEST(RemoveSlivers, KeepsTheSurfaceAndItsTopology) {
  // each vertex of a few is moved almost onto the middle of the opposite side, in a thin lens where flips would fold
  geometry::TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 10, 3);
  for (math::Vec3& p : mesh.positions) p.z *= 0.2;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 97) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.positions[a] += 0.985 * (0.5 * (mesh.positions[b] + mesh.positions[c]) - mesh.positions[a]);
  }
  const auto before = geometry::InspectMesh(mesh);
  ASSERT_GT(CountSlivers(mesh, 5.0), 5u);
  geometry::TriangleMesh again = mesh;
  SliverSettings settings;
  settings.fewest_triangles = mesh.triangles.size();
  EXPECT_EQ(RemoveSlivers(mesh, settings), 0u);
  const auto after = geometry::InspectMesh(mesh);
  EXPECT_TRUE(after.closed && after.manifold && after.outward);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.triangles, before.triangles);
  EXPECT_EQ(geometry::CountSelfIntersections(mesh), 0u);
  EXPECT_NEAR(after.volume, before.volume, 0.02 * before.volume);
  RemoveSlivers(again, settings);
  EXPECT_EQ(again, mesh);
}

}  // namespace
}  // namespace trocar::meshing
