// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/tube.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::geometry {
namespace {

CentreLine Arc(double radius, int count) {
  CentreLine line;
  for (int i = 0; i < count; ++i) {
    const double angle = M_PI * i / (count - 1);
    line.points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    line.radii.push_back(0.002);
  }
  return line;
}

// Analytic: Pappus, volume = cross-section times the way of its centre.
TEST(MakeTube, OfAnArcIsClosedAndHasPappusVolume) {
  const TriangleMesh tube = MakeTube(Arc(0.03, 60), 32);
  const MeshReport report = InspectMesh(tube);
  EXPECT_TRUE(report.closed && report.manifold && report.outward);
  EXPECT_NEAR(report.volume / (M_PI * 0.002 * 0.002 * M_PI * 0.03), 1.0, 0.01);
}

TEST(Resample, KeepsEndsLengthAndSpacing) {
  const CentreLine line = Arc(0.03, 12);
  const CentreLine fine = Resample(line, 0.004);
  EXPECT_EQ(fine.points.front(), line.points.front());
  EXPECT_EQ(fine.points.back(), line.points.back());
  EXPECT_NEAR(CalcLength(fine), M_PI * 0.03, 0.001);
  for (std::size_t i = 1; i < fine.points.size(); ++i) {
    EXPECT_NEAR(math::Distance(fine.points[i - 1], fine.points[i]), 0.004, 0.0005);
  }
}

TEST(CalcTubeSkin, HandlesAHairpinWithoutNan) {
  const CentreLine line{{{0, 0, 0}, {0.01, 0, 0}, {0, 0, 0}}, {0.001, 0.001, 0.001}};
  for (const math::Vec3& p : MakeTube(line, 8).positions) EXPECT_TRUE(math::IsFinite(p));
}

}  // namespace
}  // namespace trocar::geometry
