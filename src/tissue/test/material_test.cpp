// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"

namespace trocar::tissue {
namespace {

// Analytic: k = (sqrt(3) / 2) E t for inner edges of the equilateral lattice, half of it at the rim.
TEST(CalcEdgeStiffness, OfEquilateralTrianglesIsTheLatticeFormula) {
  const auto mesh = geometry::MakeTriangularLattice(5, 5, 0.003);
  const auto edges = geometry::FindEdges(mesh.triangles);
  const auto stiffness = CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, 510.0);
  const double inner = std::sqrt(3.0) / 2.0 * 510.0;
  int inner_count = 0;
  for (const double k : stiffness) {
    EXPECT_TRUE(std::abs(k - inner) < 1e-9 || std::abs(k - 0.5 * inner) < 1e-9) << k;
    inner_count += std::abs(k - inner) < 1e-9;
  }
  EXPECT_EQ(inner_count, 56 - 16);  // 16 of the 56 edges are on the rim
}

TEST(CalcFoundationStiffness, AddsUpToModulusTimesAreaOverDepth) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.05, 3);
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  const auto stiffness = CalcFoundationStiffness(areas, 5400.0, 0.08);
  EXPECT_NEAR(std::accumulate(stiffness.begin(), stiffness.end(), 0.0) / (5400.0 / 0.08 * 4 * M_PI * 0.0025),
              1.0, 0.01);
}

TEST(CalcTubeStiffness, IsHookesLawOfARing) {
  EXPECT_NEAR(CalcTubeStiffness(498e3, 0.002, 0.0007, 0.004), 498e3 * 2 * M_PI * 0.002 * 0.0007 / 0.004,
              1e-9);
}

}  // namespace
}  // namespace trocar::tissue
