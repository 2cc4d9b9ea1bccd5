// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/volume_mesher.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "trocar/images/image_stack.h"
#include "trocar/math/random.h"
#include "trocar/meshing/label_volume.h"
#include "trocar/meshing/marching_cubes.h"

namespace trocar::meshing {
namespace {

using math::Vec3;

/// Samples of one half inside and minus one half outside: as hard as labels are.
template <typename IsInside>
ScalarVolume MakeLabels(std::array<int, 3> size, IsInside is_inside) {
  ScalarVolume volume{1.0, {-size[0] / 2, -size[1] / 2, -size[2] / 2}, size, {}};
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i)
        volume.values.push_back(is_inside(volume.Position(i, j, k)) ? 0.5f : -0.5f);
    }
  }
  return volume;
}

MeshedVolume Mesh(const ScalarVolume& volume, int triangles, double oversampling = 12) {
  MeshingSettings settings;
  settings.triangle_budget = triangles;
  settings.oversampling = oversampling;
  auto meshed = MeshVolume(volume, settings);
  EXPECT_TRUE(meshed.ok()) << meshed.error().Text();
  return meshed.ok() ? std::move(*meshed) : MeshedVolume{};
}

void ExpectSound(const MeshedVolume& meshed, int triangles, const std::string& what) {
  const MeshQuality& quality = meshed.quality;
  EXPECT_TRUE(quality.IsSound()) << what << ": " << quality.self_intersections << " cuts";
  EXPECT_EQ(quality.surface.components, 1u) << what;
  EXPECT_LE(quality.surface.triangles, static_cast<std::size_t>(triangles)) << what;
  EXPECT_GE(static_cast<double>(quality.surface.triangles), 0.98 * triangles) << what;
  EXPECT_LT(std::fabs(quality.volume_change), 0.005) << what;
  EXPECT_GT(quality.surface.min_angle, 5.0 * M_PI / 180) << what;
}

TEST(MeshVolume, MakesARoundBallOfAStaircase) {
  const auto meshed = Mesh(MakeLabels({50, 50, 50}, [](const Vec3& p) { return Norm(p) < 20.3; }), 800);
  ExpectSound(meshed, 800, "ball");
  EXPECT_EQ(meshed.quality.surface.genus, 0);
  EXPECT_GT(meshed.quality.surface.mean_min_angle, 40 * M_PI / 180);
  EXPECT_LT(meshed.quality.distance.Hausdorff(), 1.0);
  // no stairs: the triangles look outwards as the ball does, where stairs would turn them by 45 degrees
  double worst = 1, mean = 0;
  for (const auto& t : meshed.mesh.triangles) {
    const Vec3 middle =
        (meshed.mesh.positions[t[0]] + meshed.mesh.positions[t[1]] + meshed.mesh.positions[t[2]]) / 3.0;
    const double cosine =
        Dot(math::Normalized(geometry::CalcAreaNormal(meshed.mesh.positions, t)), math::Normalized(middle));
    worst = std::min(worst, cosine), mean += cosine / static_cast<double>(meshed.mesh.triangles.size());
    EXPECT_NEAR(Norm(middle), 20.0, 0.8);
  }
  EXPECT_GT(worst, std::cos(16 * M_PI / 180));
  EXPECT_GT(mean, std::cos(5 * M_PI / 180));
}

TEST(MeshVolume, KeepsTheVolumeOfThinPlates) {
  for (const int thickness : {2, 3, 5}) {
    const auto meshed = Mesh(MakeLabels({52, 44, 20},
                                        [&](const Vec3& p) {
                                          return std::fabs(p.x) < 21 && std::fabs(p.y) < 17 && p.z > -0.5 &&
                                                 p.z < thickness - 0.5;
                                        }),
                             1200);
    ExpectSound(meshed, 1200, std::to_string(thickness) + " voxels");
    EXPECT_EQ(meshed.quality.surface.genus, 0);
  }
}

TEST(MeshVolume, KeepsASlantedWedgesEdge) {
  // the liver's lower edge: two faces that meet at 20 degrees
  const auto meshed = Mesh(MakeLabels({70, 50, 40},
                                      [](const Vec3& p) {
                                        return p.x > -28 && p.x < 28 && std::fabs(p.y + 0.3 * p.x) < 14 &&
                                               std::fabs(p.z) < (28 - p.x) * std::tan(10 * M_PI / 180);
                                      }),
                           1500);
  ExpectSound(meshed, 1500, "wedge");
  EXPECT_GT(geometry::CalcBox(meshed.mesh.positions).max.x, 15);
}

TEST(MeshVolume, HalvesAFineVolumeAndKeepsItsShape) {
  const auto labels = MakeLabels({84, 84, 84}, [](const Vec3& p) { return Norm(p) < 38 && p.z < 20; });
  const auto halved = Mesh(labels, 500), whole = Mesh(labels, 500, 1e9);
  ExpectSound(halved, 500, "halved");
  ExpectSound(whole, 500, "whole");
  EXPECT_NE(halved.mesh, whole.mesh);
  EXPECT_LT(halved.quality.distance.mean_from_mesh, 1.4 * whole.quality.distance.mean_from_mesh + 0.05);
  EXPECT_LT(halved.quality.distance.Hausdorff(), 3.0);
}

TEST(MeshVolume, DoesNotLoseAPartToHalving) {
  // two balls joined by a bar of two voxels, which a halved volume does not carry
  const auto labels = MakeLabels({100, 50, 50}, [](const Vec3& p) {
    const bool in_bar = std::fabs(p.x) < 30 && p.y >= 0 && p.y < 2 && p.z >= 0 && p.z < 2;
    return Norm(p - Vec3{-28, 0, 0}) < 18 || Norm(p - Vec3{30, 0, 0}) < 8 || in_bar;
  });
  const auto meshed = Mesh(labels, 300);
  EXPECT_GT(geometry::CalcBox(meshed.mesh.positions).max.x, 34);
  EXPECT_EQ(meshed.quality.surface.components, 1u);
}

TEST(MeshVolume, KeepsTheLargestPartWithoutCavities) {
  const auto meshed =
      Mesh(MakeLabels({60, 40, 40},
                      [](const Vec3& p) {
                        const bool in_cavity = Norm(p - Vec3{-10, 2, 0}) < 5;
                        return (Norm(p - Vec3{-10, 0, 0}) < 15 && !in_cavity) || Norm(p - Vec3{20, 0, 0}) < 6;
                      }),
           600);
  ExpectSound(meshed, 600, "one part");
  EXPECT_LT(geometry::CalcBox(meshed.mesh.positions).max.x, 6);
}

TEST(MeshVolume, RandomBlobsAreSound) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    math::Random random(seed);
    std::vector<Vec3> centres;
    std::vector<double> radii;
    for (int i = 0; i < 9; ++i) {
      centres.push_back({random.Uniform(-12, 12), random.Uniform(-12, 12), random.Uniform(-12, 12)});
      radii.push_back(random.Uniform(3, 10));
    }
    // an odd number of balls: shells, necks and tunnels of a voxel or two, a genus of up to 50
    const auto in_odd = [&](const Vec3& p) {
      bool inside = false;
      for (std::size_t i = 0; i < 9; ++i) inside ^= Norm(p - centres[i]) < radii[i];
      return inside;
    };
    const auto in_some = [&](const Vec3& p) {
      bool inside = false;
      for (std::size_t i = 0; i < 9; ++i) inside = Norm(p - centres[i]) < radii[i] ? i < 6 : inside;
      return inside;
    };
    const std::string what = "seed " + std::to_string(seed);
    const auto some = Mesh(MakeLabels({48, 48, 48}, in_some), 1500);
    EXPECT_TRUE(some.quality.IsSound()) << what << ": " << some.quality.self_intersections;
    EXPECT_LT(std::fabs(some.quality.volume_change), 0.005) << what;
    // what the budget cannot show may cut itself: then the report says so
    const auto odd = Mesh(MakeLabels({48, 48, 48}, in_odd), 1500);
    const auto surface = geometry::InspectMesh(odd.mesh);
    EXPECT_TRUE(surface.closed && surface.manifold && surface.outward) << what;
    EXPECT_EQ(odd.quality.self_intersections, geometry::CountSelfIntersections(odd.mesh)) << what;
    EXPECT_LE(odd.quality.self_intersections, 12u) << what;
    EXPECT_LT(std::fabs(odd.quality.volume_change), 0.005) << what;
  }
}

TEST(MeshVolume, RefusesAnEmptyVolume) {
  const auto meshed = MeshVolume(MakeLabels({5, 5, 5}, [](const Vec3&) { return false; }));
  ASSERT_FALSE(meshed.ok());
  EXPECT_EQ(meshed.error().code, base::ErrorCode::kContourEmpty);
}

TEST(MeshVolume, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto labels = MakeLabels({60, 40, 40}, [](const Vec3& p) { return Norm(p) < 18 && p.x < 9; });
  const auto many = Mesh(labels, 500);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const auto single = Mesh(labels, 500);
  EXPECT_EQ(single.mesh, many.mesh);
  EXPECT_EQ(single.quality.distance.Hausdorff(), many.quality.distance.Hausdorff());
}

TEST(HalveResolution, KeepsALinearFunctionAndThePlaces) {
  for (const int first : {-7, -4, 0, 3}) {
    ScalarVolume volume{0.5, {first, first + 1, first - 1}, {11, 10, 9}, {}};
    const auto linear = [](const Vec3& p) { return static_cast<float>(p.x - 2 * p.y + 0.5 * p.z + 40); };
    for (int k = 0; k < 9; ++k) {
      for (int j = 0; j < 10; ++j) {
        for (int i = 0; i < 11; ++i) volume.values.push_back(linear(volume.Position(i, j, k)));
      }
    }
    const ScalarVolume half = HalveResolution(volume);
    EXPECT_EQ(half.spacing, 1.0);
    int compared = 0;
    for (int k = 0; k < half.size[2]; ++k) {
      for (int j = 0; j < half.size[1]; ++j) {
        for (int i = 0; i < half.size[0]; ++i) {
          bool is_inner = true;
          const int at[3] = {i, j, k};
          for (int axis = 0; axis < 3; ++axis) {
            const int fine = 2 * (half.first[axis] + at[axis]) - volume.first[axis];
            is_inner = is_inner && fine >= 1 && fine + 1 < volume.size[axis];
          }
          if (!is_inner) continue;
          EXPECT_NEAR(half.values[half.Index(i, j, k)], linear(half.Position(i, j, k)), 1e-4);
          ++compared;
        }
      }
    }
    EXPECT_GE(compared, 48);
  }
}

// The reference labels of the Visible Human, as another person's tool would hand them over.
TEST(MeshVolumeSlow, MeshesRaggedLabelsOfTheVisibleHuman) {
  namespace fs = std::filesystem;
  const fs::path file = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/reference/labels.nii.gz";
  if (!fs::exists(file)) GTEST_SKIP() << file.parent_path() << " is not there";
  const auto labels = images::ReadLabelVolume(file);
  ASSERT_TRUE(labels.ok());
  for (const int label : {1, 2}) {
    const auto count = std::count(labels->labels.begin(), labels->labels.end(), label);
    for (const int triangles : {1000, 1798, 5132, 9000}) {
      const double voxel = 1.056 * 1.056;
      auto volume = MakeLabelVolume(FillLabelSlices(*labels, label, {1.056, 1.056, 1.0}, 1.056), 1.056,
                                    static_cast<double>(count) * voxel);
      ASSERT_TRUE(volume.ok());
      ExpectSound(Mesh(*volume, triangles), triangles,
                  "label " + std::to_string(label) + ", " + std::to_string(triangles));
    }
  }
}

}  // namespace
}  // namespace trocar::meshing
