// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/material.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// Analytic: on the equilateral lattice k = (sqrt(3) / 6) E t across inner edges.
TEST(CalcBendingSprings, OfEquilateralTrianglesAreTheSecondNeighbourLattice) {
  const auto mesh = geometry::MakeTriangularLattice(5, 5, 0.003);
  const auto springs = CalcBendingSprings(mesh.positions, mesh.triangles, 510.0);
  EXPECT_EQ(springs.size(), 40u) << "one for each inner edge";
  for (const BendingSpring& spring : springs) {
    EXPECT_LT(spring.a, spring.b);
    EXPECT_NEAR(math::Distance(mesh.positions[spring.a], mesh.positions[spring.b]), 0.003 * std::sqrt(3.0),
                1e-12);
    EXPECT_NEAR(spring.stiffness, std::sqrt(3.0) / 6.0 * 510.0, 1e-9);
  }
}

TEST(CalcBendingSprings, CornersThatFaceEachOtherTwiceShareOneSpring) {
  // a tetrahedron: the corners across each edge are those of the opposite edge
  const geometry::TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                    {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  EXPECT_EQ(CalcBendingSprings(mesh.positions, mesh.triangles, 1.0).size(), 6u);
}

/// Modulus E t and Poisson's ratio of a periodic-free patch in plane strain, from energies of small pure
/// strains of its inner springs: exact for any lattice whose springs deform affinely.
struct Elasticity {
  double modulus, poisson;
};
Elasticity MeasureLattice(double bending_share) {
  const int n = 41;
  const double side = 0.003, membrane = 510.0;
  const auto mesh = geometry::MakeTriangularLattice(n, n, side);
  const auto edges = geometry::FindEdges(mesh.triangles);
  const auto stiffness =
      CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, (1 - bending_share) * membrane);
  struct Link {
    math::Vec3 along;
    double k;
  };
  std::vector<Link> links;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    links.push_back({mesh.positions[edges[i][1]] - mesh.positions[edges[i][0]], stiffness[i]});
  }
  for (const auto& s : CalcBendingSprings(mesh.positions, mesh.triangles, bending_share * membrane)) {
    links.push_back({mesh.positions[s.b] - mesh.positions[s.a], s.stiffness});
  }
  const double area = geometry::CalcArea(mesh.positions, mesh.triangles);
  const auto c = [&](int i, int j) {
    double sum = 0;
    for (const Link& link : links) {
      const math::Vec3 u = math::Normalized(link.along);
      sum += link.k * math::SquaredNorm(link.along) * u[i] * u[i] * u[j] * u[j] / area;
    }
    return sum;
  };
  const double c11 = c(0, 0), c12 = c(0, 1);
  return {c11 - c12 * c12 / c11, c12 / c11};
}

TEST(CalcBendingSprings, ShareTheModulusWithTheEdgesAndKeepPoissonsRatio) {
  for (const double share : {0.0, 0.3, 0.75, 1.0}) {
    const Elasticity found = MeasureLattice(share);
    EXPECT_NEAR(found.modulus / 510.0, 1.0, 0.04) << share;  // the rim lacks springs
    EXPECT_NEAR(found.poisson, 1.0 / 3.0, 0.02) << share;
  }
}

TEST(CalcBendingShare, GrowsWithTheSquareOfTheThicknessUpToThreeQuarters) {
  EXPECT_NEAR(CalcBendingShare(0.1e-3, 2.6e-3), 2.4317 * std::pow(0.1 / 2.6, 2), 1e-5);
  EXPECT_EQ(CalcBendingShare(2e-3, 2.6e-3), 0.75) << "a gallbladder's wall";
  EXPECT_LT(CalcBendingShare(0.04e-3, 4e-3), 1e-3) << "the liver's capsule hardly bends";
  EXPECT_EQ(CalcBendingShare(0.0, 4e-3), 0.0);
}

// Domain facts 3.2: the numbers that a developer can check.
TEST(Material, GivesTheGoldenValuesOfTheDomain) {
  // gallbladder wall: E = 3 G = 255 kPa, 2 mm: 510 N/m, about 440 N/m an edge, whatever its length
  for (const double side : {0.001, 0.003, 0.01}) {
    const auto mesh = geometry::MakeTriangularLattice(7, 7, side);
    const auto edges = geometry::FindEdges(mesh.triangles);
    const auto stiffness = CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, 3 * 85e3 * 2e-3);
    EXPECT_NEAR(*std::max_element(stiffness.begin(), stiffness.end()), 441.7, 0.1);
  }
  // liver: E = 5.4 kPa, 80 mm deep, 1 cm^2: 6.8 N/m
  const std::vector<double> areas{1e-4};
  EXPECT_NEAR(CalcFoundationStiffness(areas, 5400.0, 0.08)[0], 6.75, 1e-9);
  // a flat 5 mm tool on a half-space of liver: 36 N/m
  EXPECT_NEAR(CalcPunchStiffness(5400.0, 0.5, 0.0025), 36.0, 1e-9);
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
