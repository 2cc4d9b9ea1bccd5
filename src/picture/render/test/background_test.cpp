// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/background.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"

namespace trocar::render {
namespace {

using math::Vec3;

const BackgroundPart& Find(const std::vector<BackgroundPart>& parts, const char* name) {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  EXPECT_NE(found, parts.end()) << name;
  return *found;
}

TEST(MakeAbdomen, WallEnclosesTheOrgansAndFacesInwards) {
  const auto organ =
      geometry::MakeSphere({-0.09, 0.12, -0.16}, 0.11, 3);  // stands out of the plain ellipsoid
  const auto parts = MakeAbdomen(organ.positions, {});
  const auto& wall = Find(parts, "wall").mesh;
  const auto report = geometry::InspectMesh(wall);
  EXPECT_TRUE(report.closed && report.manifold);
  EXPECT_LT(report.volume, 0.0);
  // star-shaped about its middle: the wall lies beyond every point in that point's direction
  const Vec3 middle{-0.010, 0.050, -0.100};
  for (const Vec3& p : organ.positions) {
    const Vec3 d = math::Normalized(p - middle);
    double nearest_cosine = -1, radius = 0;
    for (const Vec3& q : wall.positions) {
      const double cosine = math::Dot(math::Normalized(q - middle), d);
      if (cosine > nearest_cosine) nearest_cosine = cosine, radius = math::Norm(q - middle);
    }
    EXPECT_GT(radius, math::Norm(p - middle));
  }
}

TEST(MakeAbdomen, WallPassesThePorts) {
  const auto parts = MakeAbdomen({}, {});
  const auto& wall = Find(parts, "wall").mesh;
  for (const Vec3& port : {Vec3{0, 0, 0}, Vec3{-0.015, 0.130, -0.005}, Vec3{-0.085, 0.080, -0.015}}) {
    double nearest = 1;
    for (const Vec3& q : wall.positions) nearest = std::min(nearest, math::Distance(q, port));
    EXPECT_LT(nearest, 0.025);
  }
}

TEST(MakeAbdomen, OmentumPassesUnderWhatMustStayInSight) {
  const std::vector<Obstacle> above{{{-0.06, 0.10, -0.125}, 0.010}, {{0.0, 0.05, -0.14}, 0.003}};
  const auto parts = MakeAbdomen({}, above);
  for (const Vec3& p : Find(parts, "omentum").mesh.positions) {
    for (const Obstacle& o : above) {
      if (std::hypot(p.x - o.centre.x, p.y - o.centre.y) < o.radius) {
        EXPECT_LT(p.z, o.centre.z);
      }
    }
  }
}

TEST(MakeAbdomen, GivesTheSameBitsAgain) {
  const auto one = MakeAbdomen({}, {}), two = MakeAbdomen({}, {});
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(geometry::CheckMesh(one[i].mesh).ok());
    EXPECT_EQ(one[i].mesh, two[i].mesh);
  }
}

}  // namespace
}  // namespace trocar::render
