// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "random_cuts.h"

namespace trocar::geometry {
namespace {

void Report(const CutCounts& counts) {
  std::printf(
      "%zu strokes, %zu ticks: %zu edges split, %zu vertices inserted, %zu edges opened, %zu wall triangles, "
      "%zu edges left uncut, pools full in %zu ticks\n",
      counts.strokes, counts.ticks, counts.splits, counts.inserted, counts.opened, counts.walls,
      counts.refused, counts.full);
}

TEST(SurfaceCutProperty, RandomCutsLeaveGoodSurfaces) {
  const CutCounts counts = RunRandomCuts(1, 1000, [](const std::string&, const EditableMesh&) {});
  Report(counts);
  EXPECT_EQ(counts.strokes, 1000u);
  // the strokes do cut
  EXPECT_GT(counts.opened, 3000u);
  EXPECT_GT(counts.walls, 1000u);
  EXPECT_GT(counts.full, 5u);
}

TEST(SurfaceCutPropertySlow, TenThousandRandomCutsLeaveGoodSurfaces) {
  const CutCounts counts = RunRandomCuts(2, 10000, [](const std::string&, const EditableMesh&) {});
  Report(counts);
  EXPECT_EQ(counts.strokes, 10000u);
}

// The same strokes give the same bits.
TEST(SurfaceCutProperty, RepeatsItself) {
  std::vector<TriangleMesh> first, second;
  RunRandomCuts(3, 40,
                [&](const std::string&, const EditableMesh& mesh) { first.push_back(mesh.PresentMesh()); });
  RunRandomCuts(3, 40,
                [&](const std::string&, const EditableMesh& mesh) { second.push_back(mesh.PresentMesh()); });
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace trocar::geometry
