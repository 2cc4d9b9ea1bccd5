// SPDX-License-Identifier: Apache-2.0
#include "omentum_drape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/geometry/primitives.h"

namespace trocar::view {
namespace {

using math::Vec3;

/// A flat field of 0.12 m about the origin, 0.012 m under z = 0.
geometry::TriangleMesh MakeField() {
  geometry::TriangleMesh field = geometry::MakeGrid(60, 0.002);
  for (Vec3& p : field.positions) p += Vec3{-0.06, -0.06, -0.012};
  return field;
}

double HeightAt(const geometry::TriangleMesh& field, double x, double y) {
  const auto nearest =
      std::min_element(field.positions.begin(), field.positions.end(), [&](const Vec3& a, const Vec3& b) {
        return std::hypot(a.x - x, a.y - y) < std::hypot(b.x - x, b.y - y);
      });
  return nearest->z;
}

TEST(OmentumDrape, CoversLooseEndsAndLeavesWhereTubesMeetBare) {
  const std::vector<TubeLine> tubes = {{{{-0.04, 0, 0}, {0, 0, 0}, {0.03, 0, 0}}, 0.002, false},
                                       {{{0, 0.003, 0}, {0, 0.03, 0}}, 0.001, false}};
  const std::vector<Vec3> organ = {{-0.04, 0.003, 0}, {0, 0.03, 0.004}};
  const auto places = FindCoveredPlaces(tubes, organ);
  geometry::TriangleMesh field = MakeField();
  const auto raised = DrapeOmentum(places, field);
  EXPECT_GT(HeightAt(field, 0.03, 0), 0.002) << "the loose end lies under fat";
  EXPECT_LT(HeightAt(field, 0, 0), -0.002) << "where another joins it is seen";
  EXPECT_LT(HeightAt(field, 0, 0.03), -0.002) << "and where it runs into an organ";
  EXPECT_NEAR(HeightAt(field, -0.055, -0.055), -0.012, 1e-12) << "far away nothing is raised";
  EXPECT_EQ(std::count(raised.begin(), raised.end(), 0.0) > 100, true);
}

TEST(OmentumDrape, ADuctInFatComesOutOfItOnlyNearItsJoint) {
  TubeLine duct{{}, 0.002, true};
  for (int i = 0; i <= 20; ++i) duct.nodes.push_back({-0.05 + 0.005 * i, 0, 0});
  const std::vector<TubeLine> tubes = {duct, {{{0, 0.003, 0}, {0, 0.03, 0}}, 0.001, false}};
  geometry::TriangleMesh field = MakeField();
  DrapeOmentum(FindCoveredPlaces(tubes, {}), field);
  EXPECT_LT(HeightAt(field, 0, 0), -0.002);
  EXPECT_GT(HeightAt(field, 0.024, 0), 0.002);
  EXPECT_GT(HeightAt(field, -0.024, 0), 0.002);
  // negative control: the same duct where it was dissected
  std::vector<TubeLine> bare = tubes;
  bare[0].is_in_fat = false;
  geometry::TriangleMesh other = MakeField();
  DrapeOmentum(FindCoveredPlaces(bare, {}), other);
  EXPECT_LT(HeightAt(other, 0.024, 0), -0.002);
}

TEST(OmentumDrape, RimsAreRoundAndNothingRises) {
  geometry::TriangleMesh cliff = MakeField();
  for (Vec3& p : cliff.positions)
    if (p.x > 0) p.z -= 0.02;
  geometry::TriangleMesh round = cliff;
  RoundRims(round);
  double steepest_before = 0, steepest = 0;
  for (const auto& [a, b, c] : cliff.triangles) {
    steepest_before = std::max(steepest_before, std::abs(cliff.positions[a].z - cliff.positions[b].z));
    steepest = std::max(steepest, std::abs(round.positions[a].z - round.positions[b].z));
  }
  EXPECT_LT(steepest, 0.75 * steepest_before);
  for (std::size_t v = 0; v < cliff.positions.size(); ++v)
    EXPECT_LE(round.positions[v].z, cliff.positions[v].z);
  EXPECT_EQ(HeightAt(round, -0.05, 0), HeightAt(cliff, -0.05, 0)) << "level ground stays";
}

}  // namespace
}  // namespace trocar::view
