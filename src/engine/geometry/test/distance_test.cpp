// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

Vec3 RandomPoint(math::Random& random, double reach = 1.0) {
  return {random.Uniform(-reach, reach), random.Uniform(-reach, reach), random.Uniform(-reach, reach)};
}

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  return math::Distance(p, a + FindNearestOnSegment(p, a, b) * (b - a));
}

// Oracle: no point of a fine barycentric grid is nearer, and the best grid point is not much farther.
TEST(FindNearestOnTriangle, AgreesWithADenseSearch) {
  math::Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 p = 2.0 * RandomPoint(random), a = RandomPoint(random), b = RandomPoint(random),
               c = RandomPoint(random);
    const TrianglePoint nearest = FindNearestOnTriangle(p, a, b, c);
    const double distance = math::Distance(p, nearest.point);
    double best = 1e9;
    constexpr int kSteps = 100;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = double(i) / kSteps, v = double(j) / kSteps;
        best = std::min(best, math::Distance(p, u * a + v * b + (1 - u - v) * c));
      }
    }
    EXPECT_LE(distance, best + 1e-12) << "trial " << trial;
    EXPECT_GE(distance, best - 0.03) << "trial " << trial;
    EXPECT_NEAR(nearest.weights[0] + nearest.weights[1] + nearest.weights[2], 1.0, 1e-12);
  }
}

TEST(FindNearestOnTriangle, TreatsADegenerateTriangleAsItsLongestSide) {
  const TrianglePoint nearest = FindNearestOnTriangle({1, 1, 0}, {0, 0, 0}, {2, 0, 0}, {4, 0, 0});
  EXPECT_NEAR(math::Distance(nearest.point, {1, 0, 0}), 0.0, 1e-15);
  const TrianglePoint at_point = FindNearestOnTriangle({1, 1, 0}, {2, 0, 0}, {2, 0, 0}, {2, 0, 0});
  EXPECT_EQ(at_point.point, (Vec3{2, 0, 0}));
}

// Oracle: a sliver of height h lies within h of its longest side, so its distance lies within h of that
// side's.
TEST(FindNearestOnTriangle, HoldsOnSlivers) {
  math::Random random(22);
  for (int trial = 0; trial < 4000; ++trial) {
    const Vec3 a = RandomPoint(random), b = RandomPoint(random), p = RandomPoint(random, 2);
    const double height = std::pow(10.0, random.Uniform(-20, -4));
    const Vec3 c = a + random.Uniform() * (b - a) + height * math::AnyPerpendicular(math::Normalized(b - a));
    const TrianglePoint nearest = FindNearestOnTriangle(p, a, b, c);
    const double distance = math::Distance(p, nearest.point);
    EXPECT_NEAR(distance, DistanceToSegment(p, a, b), height + 1e-14)
        << "trial " << trial << " height " << height;
    for (const double weight : nearest.weights) {
      EXPECT_GE(weight, 0.0);
      EXPECT_LE(weight, 1.0);
    }
    const Vec3 again = nearest.weights[0] * a + nearest.weights[1] * b + nearest.weights[2] * c;
    EXPECT_NEAR(math::Distance(again, nearest.point), 0.0, 1e-14);
  }
}

TEST(FindNearestOnTriangle, TreatsATriangleOfOnePointAsThatPoint) {
  const Vec3 a{0.1, 0.2, 0.3};
  EXPECT_EQ(FindNearestOnTriangle({1, 1, 1}, a, a, a).point, a);
}

TEST(TrianglesIntersect, KnowsCrossingTouchingAndApart) {
  const Vec3 flat[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Vec3 crossing[3] = {{1, 1, -1}, {1, 1, 1}, {2, 1, 1}};
  const Vec3 above[3] = {{1, 1, 1}, {1, 2, 1}, {2, 1, 1}};
  const Vec3 coplanar_inside[3] = {{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}};
  const Vec3 coplanar_beside[3] = {{5, 5, 0}, {6, 5, 0}, {5, 6, 0}};
  EXPECT_TRUE(TrianglesIntersect(flat, crossing));
  EXPECT_FALSE(TrianglesIntersect(flat, above));
  EXPECT_TRUE(TrianglesIntersect(flat, coplanar_inside));
  EXPECT_FALSE(TrianglesIntersect(flat, coplanar_beside));
}

}  // namespace
}  // namespace trocar::geometry
