// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/centre_line_cut.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::geometry {
namespace {

/// Two ducts that join a third: a Y of 30 mm legs.
CentreLineGraph MakeY() {
  CentreLineGraph graph;
  std::vector<math::Vec3> points;
  std::vector<double> radii;
  for (int i = 0; i <= 6; ++i) {
    points.push_back({0.005 * i, 0, 0});
    radii.push_back(0.002 + 0.0002 * i);
  }
  AddLine(points, radii, graph);
  for (auto& p : points) p = {0.030 + 0.7 * p.x, 0.7 * p.x + 0.001, 0};
  const std::uint32_t first = AddLine(points, radii, graph);
  graph.edges.push_back({6, first});
  graph.ReserveCuts(50);
  return graph;
}

std::size_t CountPieces(const CentreLineGraph& graph) {
  std::vector<std::uint32_t> piece(graph.rest.size());
  for (std::uint32_t i = 0; i < piece.size(); ++i) piece[i] = i;
  for (std::size_t round = 0; round < piece.size(); ++round) {
    for (const Edge& edge : graph.edges)
      piece[edge[0]] = piece[edge[1]] = std::min(piece[edge[0]], piece[edge[1]]);
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < piece.size(); ++i) count += piece[i] == i ? 1 : 0;
  return count;
}

double CalcLength(const CentreLineGraph& graph) {
  double length = 0;
  for (const Edge& edge : graph.edges) length += math::Distance(graph.rest[edge[0]], graph.rest[edge[1]]);
  return length;
}

FlatSweep Across(double x, double y) {
  return MakeFlatMoves({{x, y - 0.005, -0.005}, {x, y - 0.005, 0.005}},
                       {{x, y + 0.005, -0.005}, {x, y + 0.005, 0.005}})
      .moves[0]
      .sweep;
}

TEST(CentreLineCut, DividesWhereTheBladePasses) {
  CentreLineGraph graph = MakeY();
  const double length = CalcLength(graph);
  ASSERT_EQ(CountPieces(graph), 1u);
  std::array<CentreLineCut, 4> cuts;
  ASSERT_EQ(CutCentreLines(Across(0.0115, 0), graph, cuts), 1u);
  EXPECT_EQ(cuts[0].a, 2u);
  EXPECT_EQ(cuts[0].b, 3u);
  EXPECT_NEAR(cuts[0].t, 0.3, 1e-12);
  for (const auto end : cuts[0].ends) {
    EXPECT_NEAR(math::Distance(graph.rest[end], {0.0115, 0, 0}), 0.0, 1e-15);
    EXPECT_NEAR(graph.radii[end], 0.002 + 0.0002 * 2.3, 1e-15);
    EXPECT_EQ(graph.is_cut_end[end], 1);
  }
  EXPECT_EQ(CountPieces(graph), 2u);
  EXPECT_NEAR(CalcLength(graph), length, 1e-15);
  // the same place again, or a hair beside it, takes nothing off the stumps
  EXPECT_EQ(CutCentreLines(Across(0.0115, 0), graph, cuts), 0u);
  EXPECT_EQ(CutCentreLines(Across(0.0117, 0), graph, cuts), 0u);
  // beside the line nothing is cut
  EXPECT_EQ(CutCentreLines(Across(0.020, 0.02), graph, cuts), 0u);
  EXPECT_EQ(CutCentreLines(Across(0.020, 0), graph, cuts), 1u);
  EXPECT_EQ(CountPieces(graph), 3u);
}

TEST(CentreLineCut, RandomCutsKeepLengthAndCountPieces) {
  CentreLineGraph graph = MakeY();
  const double length = CalcLength(graph);
  math::Random random(7);
  std::size_t made = 0;
  std::array<CentreLineCut, 8> cuts;
  for (int i = 0; i < 400; ++i)
    made += CutCentreLines(Across(random.Uniform(-0.01, 0.06), random.Uniform(-0.01, 0.03)), graph, cuts);
  EXPECT_GT(made, 15u);
  EXPECT_EQ(CountPieces(graph), 1u + made);
  EXPECT_NEAR(CalcLength(graph), length, 1e-12);
  for (const Edge& edge : graph.edges)
    EXPECT_GT(math::Distance(graph.rest[edge[0]], graph.rest[edge[1]]), 1e-6);
}

TEST(CentreLineCut, StopsWhenItsRoomIsUsedUp) {
  CentreLineGraph graph;
  AddLine(std::vector<math::Vec3>{{0, 0, 0}, {0.1, 0, 0}}, std::vector<double>{0.002, 0.002}, graph);
  graph.rest.shrink_to_fit();
  graph.edges.shrink_to_fit();
  std::array<CentreLineCut, 1> cuts;
  EXPECT_EQ(CutCentreLines(Across(0.05, 0), graph, cuts), 0u);
  graph.ReserveCuts(1);
  EXPECT_EQ(CutCentreLines(Across(0.05, 0), graph, cuts), 1u);
}

}  // namespace
}  // namespace trocar::geometry
