// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/marching_cubes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/random.h"

namespace trocar::anatomy {
namespace {

ScalarVolume MakeEmpty(int nx, int ny, int nz) {
  return {1.0, {0, 0, 0}, {nx, ny, nz}, std::vector<float>(static_cast<std::size_t>(nx) * ny * nz, -1.0f)};
}

void ExpectGoodSurface(const ScalarVolume& volume, const std::string& what) {
  const auto report = geometry::InspectMesh(MarchCubes(volume));
  EXPECT_TRUE(report.closed) << what;
  EXPECT_TRUE(report.manifold) << what << ": " << report.odd_edges << " odd edges, " << report.odd_vertices
                               << " odd vertices, " << report.degenerate << " flat";
  EXPECT_TRUE(report.outward) << what;
}

TEST(MarchCubes, AllCellsGiveClosedManifoldOutwardSurfaces) {
  for (unsigned inside = 1; inside < 256; ++inside) {
    ScalarVolume volume = MakeEmpty(2, 2, 2);
    for (int c = 0; c < 8; ++c) {
      if (inside >> c & 1) volume.values[volume.Index(c & 1, c >> 1 & 1, c >> 2 & 1)] = 1.0f;
    }
    ExpectGoodSurface(volume, "case " + std::to_string(inside));
  }
}

TEST(MarchCubes, RandomVolumesGiveClosedManifoldOutwardSurfaces) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    math::Random random(seed);
    ScalarVolume volume = MakeEmpty(7, 6, 8);
    const double bias = random.Uniform(-0.8, 0.8);
    for (float& value : volume.values) value = static_cast<float>(random.Uniform(-1, 1) + bias);
    // exact zeros and full layers at the border are the hard cases
    if (seed % 3 == 0) {
      for (float& value : volume.values) value = std::round(value);
    }
    volume.values[volume.Index(3, 3, 3)] = 1.0f;  // never empty
    ExpectGoodSurface(volume, "seed " + std::to_string(seed));
  }
}

TEST(MarchCubes, AllPairsOfNeighbouringCellsAgree) {
  // two cells that share an ambiguous face, all 2^12 signs
  for (unsigned inside = 1; inside < 4096; ++inside) {
    ScalarVolume volume = MakeEmpty(3, 2, 2);
    for (int c = 0; c < 12; ++c) {
      if (inside >> c & 1) volume.values[static_cast<std::size_t>(c)] = 0.7f;
    }
    const auto report = geometry::InspectMesh(MarchCubes(volume));
    ASSERT_TRUE(report.closed && report.manifold && report.outward) << inside;
  }
}

TEST(MarchCubes, MeasuresASphere) {
  ScalarVolume volume = MakeEmpty(40, 40, 40);
  volume.first = {-20, -20, -20};
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) {
        volume.values[volume.Index(i, j, k)] = static_cast<float>(15.3 - Norm(volume.Position(i, j, k)));
      }
    }
  }
  const auto report = geometry::InspectMesh(MarchCubes(volume));
  const double expected = 4.0 / 3.0 * M_PI * std::pow(15.3, 3);
  EXPECT_NEAR(report.volume, expected, 0.01 * expected);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.components, 1u);
}

TEST(MarchCubes, NothingInsideGivesNothing) {
  EXPECT_TRUE(MarchCubes(MakeEmpty(4, 4, 4)).triangles.empty());
}

}  // namespace
}  // namespace trocar::anatomy
