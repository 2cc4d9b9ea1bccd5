// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/marching_cubes.h"

#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/random.h"

namespace trocar::meshing {
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

/// Every cut edge lies in exactly one loop.
TEST(FindCellLoops, HoldsEveryCutEdgeOnce) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    const unsigned ambiguous = FindAmbiguousFaces(inside);
    for (unsigned joined = 0; joined < 64; ++joined) {
      if ((joined & ~ambiguous) != 0) continue;
      int seen[12] = {};
      for (const CellLoop& loop : FindCellLoops(inside, joined)) {
        EXPECT_GE(loop.edges.size(), 3u);
        for (const auto e : loop.edges) ++seen[e];
      }
      for (int e = 0; e < 12; ++e) {
        const bool is_cut = (inside >> kCellEdges[e][0] & 1u) != (inside >> kCellEdges[e][1] & 1u);
        EXPECT_EQ(seen[e], is_cut ? 1 : 0) << inside << " " << joined;
      }
    }
  }
}

// the oracle walks the four corners of the face; complement and mirror give its neighbour's view
TEST(FindCellLoops, CutsOffInsideOrOutsideCornersAsTheSaddleSays) {
  // corners 0 and 3 of the face z = 0 are inside
  const unsigned face = 4;
  ASSERT_EQ(FindAmbiguousFaces(0b1001), 1u << face);
  EXPECT_EQ(FindCellLoops(0b1001, 0).size(), 2u);
  EXPECT_EQ(FindCellLoops(0b1001, 1u << face).size(), 1u);
  EXPECT_EQ(FindAmbiguousFaces(0b0001), 0u);
  EXPECT_EQ(FindAmbiguousFaces(0b01101001), 63u);
}

TEST(IsJoinedAtSaddle, FollowsTheBilinearInterpolant) {
  math::Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const auto a = static_cast<float>(random.Uniform(0.01, 1)),
               c = static_cast<float>(random.Uniform(0.01, 1));
    const auto b = static_cast<float>(-random.Uniform(0, 1)), d = static_cast<float>(-random.Uniform(0, 1));
    // f(s, t) has its saddle where both derivatives vanish
    const double twist = static_cast<double>(a) - b + c - d;
    const double s = (static_cast<double>(a) - d) / twist, t = (static_cast<double>(a) - b) / twist;
    const double saddle = a * (1 - s) * (1 - t) + b * s * (1 - t) + c * s * t + d * (1 - s) * t;
    if (std::fabs(saddle) < 1e-9) continue;
    EXPECT_EQ(IsJoinedAtSaddle(a, b, c, d), saddle > 0);
    EXPECT_EQ(IsJoinedAtSaddle(a, b, c, d), IsJoinedAtSaddle(c, d, a, b));
  }
  EXPECT_FALSE(IsJoinedAtSaddle(1, -1, 1, -1));
}

/// All signs of a cell's corners; where faces are ambiguous, every combination of saddles that the values can
/// make, each of which the neighbours beyond the faces see as well.
TEST(MarchCubes, AllCellsGiveClosedManifoldOutwardSurfacesInEverySaddleState) {
  std::size_t states = 0;
  for (unsigned inside = 1; inside < 256; ++inside) {
    const unsigned ambiguous = FindAmbiguousFaces(inside);
    std::set<unsigned> seen;
    for (unsigned large = 0; large < 256; ++large) {
      ScalarVolume volume = MakeEmpty(2, 2, 2);
      for (unsigned c = 0; c < 8; ++c) {
        const float size = large >> c & 1 ? 3.0f : 1.0f;
        volume.values[c] = inside >> c & 1 ? size : -size;
      }
      unsigned joined = 0;
      for (unsigned f = 0; f < 6; ++f) {
        if ((ambiguous >> f & 1) == 0) continue;
        const auto value = [&](std::size_t k) { return volume.values[kCellFaces[f][k & 3]]; };
        const std::size_t k = value(0) > 0 ? 0 : 1;
        if (value(k) * value(k + 2) > value(k + 1) * value(k + 3)) joined |= 1u << f;
      }
      if (!seen.insert(joined).second) continue;
      ExpectGoodSurface(volume, "case " + std::to_string(inside) + ", joined " + std::to_string(joined));
      // the volume's own border also makes ambiguous faces where values of zero meet it
      for (float& value : volume.values) value = std::max(value, 0.0f);
      ExpectGoodSurface(volume, "case " + std::to_string(inside) + " on zeros");
    }
    states += seen.size();
    for (unsigned f = 0; f < 6; ++f) {
      if ((ambiguous >> f & 1) == 0) continue;
      EXPECT_TRUE(std::any_of(seen.begin(), seen.end(), [f](unsigned j) { return (j >> f & 1) != 0; }));
      EXPECT_TRUE(std::any_of(seen.begin(), seen.end(), [f](unsigned j) { return (j >> f & 1) == 0; }));
    }
  }
  EXPECT_GT(states, 600u);
}

TEST(MarchCubes, TheSaddleDecidesWhetherPartsHangTogether) {
  for (const bool is_joined : {false, true}) {
    ScalarVolume volume = MakeEmpty(2, 2, 1);
    for (float& value : volume.values) value = is_joined ? -1.0f : -3.0f;
    volume.values[0] = volume.values[3] = is_joined ? 3.0f : 1.0f;
    EXPECT_EQ(geometry::InspectMesh(MarchCubes(volume)).components, is_joined ? 1u : 2u);
  }
}

TEST(MarchCubes, RandomVolumesGiveClosedManifoldOutwardSurfaces) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    math::Random random(seed);
    // taller than a slab of layers, so that slabs are joined at ambiguous faces too
    ScalarVolume volume = MakeEmpty(5, 4, 20);
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

TEST(MarchCubes, NoTrianglesCutEachOther) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    math::Random random(seed);
    ScalarVolume volume = MakeEmpty(6, 5, 6);
    for (float& value : volume.values) value = static_cast<float>(random.Uniform(-1, 1));
    EXPECT_EQ(geometry::CountSelfIntersections(MarchCubes(volume)), 0u) << "seed " << seed;
  }
}

TEST(MarchCubes, ThinStructuresGiveClosedManifoldOutwardSurfaces) {
  math::Random random(5);
  const auto make = [&](const char* what, auto is_inside) {
    ScalarVolume volume = MakeEmpty(9, 9, 9);
    for (int k = 0; k < 9; ++k) {
      for (int j = 0; j < 9; ++j) {
        for (int i = 0; i < 9; ++i) {
          volume.values[volume.Index(i, j, k)] =
              static_cast<float>(is_inside(i, j, k) ? random.Uniform(1e-6, 1) : -random.Uniform(0, 1));
        }
      }
    }
    ExpectGoodSurface(volume, what);
  };
  make("plate", [](int, int, int k) { return k == 4; });
  make("slanted plate", [](int i, int j, int k) { return i + j + k == 12; });
  make("diagonal thread", [](int i, int j, int k) { return i == j && j == k; });
  make("face-diagonal thread", [](int i, int j, int k) { return i == j && k == 4; });
  make("chequers", [](int i, int j, int k) { return (i + j + k) % 2 == 0; });
  make("hollow chequers", [](int i, int j, int k) { return (i + j + k) % 2 == 0 || k % 4 == 0; });
  make("wires", [](int i, int j, int k) { return (i % 2) + (j % 2) + (k % 2) >= 2; });
}

TEST(MarchCubes, TakesWhatIsNotANumberForOutside) {
  ScalarVolume volume = MakeEmpty(5, 5, 5);
  for (float& value : volume.values) value = 1.0f;
  volume.values[volume.Index(2, 2, 2)] = std::numeric_limits<float>::quiet_NaN();
  volume.values[volume.Index(1, 3, 2)] = std::numeric_limits<float>::infinity();
  volume.values[volume.Index(3, 1, 2)] = -std::numeric_limits<float>::infinity();
  volume.values[volume.Index(3, 2, 2)] = std::numeric_limits<float>::denorm_min();
  ExpectGoodSurface(volume, "odd numbers");
  EXPECT_TRUE(geometry::CheckMesh(MarchCubes(volume)).ok());
  EXPECT_EQ(geometry::InspectMesh(MarchCubes(volume)).components, 2u);
}

TEST(MarchCubes, AllPairsOfNeighbouringCellsAgree) {
  // two cells that share an ambiguous face, all 2^12 signs, values at random
  math::Random random(3);
  for (unsigned inside = 1; inside < 4096; ++inside) {
    ScalarVolume volume = MakeEmpty(3, 2, 2);
    for (unsigned c = 0; c < 12; ++c) {
      const auto size = static_cast<float>(random.Uniform(0.1, 1));
      volume.values[c] = inside >> c & 1 ? size : -size;
    }
    const auto report = geometry::InspectMesh(MarchCubes(volume));
    ASSERT_TRUE(report.closed && report.manifold && report.outward) << inside;
  }
}

TEST(MarchCubes, GivesTheSameBitsForAnyNumberOfThreads) {
  math::Random random(8);
  ScalarVolume volume = MakeEmpty(12, 11, 50);
  for (float& value : volume.values) value = static_cast<float>(random.Uniform(-1, 1));
  const auto many = MarchCubes(volume);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(MarchCubes(volume), many);
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
}  // namespace trocar::meshing
