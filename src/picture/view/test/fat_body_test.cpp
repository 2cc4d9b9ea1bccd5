// SPDX-License-Identifier: Apache-2.0
#include "fat_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::view {
namespace {

using math::Vec3;

double CalcVolume(const geometry::TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += math::Dot(mesh.positions[t[0]], math::Cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6.0;
  return sum;
}

/// Every edge has one triangle on either side.
bool IsClosed(const geometry::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      ++edges[{t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return back != edges.end() && back->second == edge.second;
  });
}

// Analytic: alone it is a ball of its radius, and it faces outwards. Flat facets on it hold an eighth less.
TEST(FatBody, ALoneLobuleIsABall) {
  FatBody body;
  const double radius = 0.0025;
  body.Make(std::vector<FatLobule>{{{0.1, -0.2, 0.03}, {}, radius}});
  ASSERT_FALSE(body.Mesh().triangles.empty());
  EXPECT_TRUE(IsClosed(body.Mesh()));
  for (const Vec3& p : body.Mesh().positions)
    EXPECT_NEAR(math::Distance(p, {0.1, -0.2, 0.03}), radius, 0.1 * radius);
  EXPECT_NEAR(CalcVolume(body.Mesh()), 4.0 / 3.0 * M_PI * radius * radius * radius, 0.15 * 6.5e-8);
}

// What a heap of spheres is not: two that touch have one skin, with a groove that is wider than a point.
TEST(FatBody, NeighboursHaveOneSkinWithASoftGroove) {
  FatBody body;
  const double radius = 0.0025;
  body.Make(
      std::vector<FatLobule>{{{0, 0, 0}, {0, 0, 0}, radius}, {{1.8 * radius, 0, 0}, {1, 0, 0}, radius}});
  EXPECT_TRUE(IsClosed(body.Mesh()));
  double groove = 0, darkest = 1;
  for (std::size_t v = 0; v < body.Mesh().positions.size(); ++v) {
    const Vec3& p = body.Mesh().positions[v];
    if (std::abs(p.x - 0.9 * radius) < 0.0006) {
      groove = std::max(groove, std::hypot(p.y, p.z));
      darkest = std::min(darkest, body.AmbientOcclusion()[v]);
    }
  }
  // two spheres would meet at a circle of 0.44 radii
  EXPECT_GT(groove, 0.6 * radius);
  EXPECT_LT(groove, 0.97 * radius);
  EXPECT_LT(darkest, 0.75) << "light reaches a groove less";
}

TEST(FatBody, ThePatternMovesWithItsLobule) {
  FatBody body;
  const Vec3 rest{0.5, 0.5, 0.5};
  body.Make(std::vector<FatLobule>{{{0.1, 0, 0}, rest, 0.002}});
  for (std::size_t v = 0; v < body.Rest().size(); ++v)
    EXPECT_LT(math::Distance(body.Rest()[v] - rest, body.Mesh().positions[v] - Vec3{0.1, 0, 0}), 1e-12);
}

TEST(FatBody, NothingIsNothing) {
  FatBody body;
  body.Make(std::vector<FatLobule>{{{0.1, 0, 0}, {}, 0.002}});
  body.Make({});
  EXPECT_TRUE(body.Mesh().positions.empty());
  EXPECT_TRUE(body.Mesh().triangles.empty());
}

}  // namespace
}  // namespace trocar::view
