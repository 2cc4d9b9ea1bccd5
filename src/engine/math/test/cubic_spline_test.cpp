// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/cubic_spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace trocar::math {
namespace {

std::vector<Vec3> CirclePoints(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back({std::cos(2 * M_PI * i / count), std::sin(2 * M_PI * i / count), 0});
  return points;
}

// Analytic: the error of a periodic cubic spline on a circle falls with the fourth power of the spacing.
TEST(CubicSpline, ApproachesACircleWithFourthOrder) {
  const auto worst_radius_error = [](int count) {
    const CubicSpline spline(CirclePoints(count), SplineEnds::kClosed);
    double worst = 0;
    for (const Vec3& p : spline.Sample(997)) worst = std::max(worst, std::abs(Norm(p) - 1.0));
    return worst;
  };
  EXPECT_LT(worst_radius_error(16), 1e-3);
  EXPECT_GT(worst_radius_error(16) / worst_radius_error(32), 12.0);
}

TEST(CubicSpline, PassesThroughItsPoints) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 2, 0}, {4, 1, 3}, {5, 5, 5}};
  for (const auto ends : {SplineEnds::kClosed, SplineEnds::kNatural}) {
    const CubicSpline spline(points, ends);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(Distance(spline.Evaluate(spline.Knots()[i]), points[i]), 0.0, 1e-12);
    }
  }
}

TEST(CubicSpline, ClosedCurveIsSmoothAtItsSeam) {
  const std::vector<Vec3> points{{0, 0, 0}, {3, 1, 0}, {4, 4, 0}, {-1, 3, 0}, {-2, 1, 0}};
  const CubicSpline spline(points, SplineEnds::kClosed);
  EXPECT_NEAR(Distance(spline.EvaluateDerivative(0), spline.EvaluateDerivative(spline.Length())), 0.0, 1e-12);
}

TEST(CubicSpline, DerivativeAgreesWithFiniteDifferences) {
  const CubicSpline spline(CirclePoints(7), SplineEnds::kClosed);
  const double h = 1e-6;
  for (double s = 0.1; s < spline.Length() - 0.1; s += 0.37) {
    const Vec3 numeric = (spline.Evaluate(s + h) - spline.Evaluate(s - h)) / (2 * h);
    EXPECT_NEAR(Distance(numeric, spline.EvaluateDerivative(s)), 0.0, 1e-8);
  }
}

TEST(CubicSpline, TwoPointsMakeALineAndRepeatedPointsAreMerged) {
  const std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 0, 0}};
  const CubicSpline spline(points, SplineEnds::kNatural);
  EXPECT_NEAR(Distance(spline.Evaluate(0.5), {0.5, 0, 0}), 0.0, 1e-15);
}

}  // namespace
}  // namespace trocar::math
