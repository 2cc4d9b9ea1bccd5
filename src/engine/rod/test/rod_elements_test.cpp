// SPDX-License-Identifier: Apache-2.0
#include "rod_elements.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace trocar::rod {
namespace {

using math::Vec3;

class JointTest : public testing::TestWithParam<int> {
 protected:
  using Unknowns = std::array<double, kElementUnknowns>;

  /// Where the joint is at first; its reference frames are carried from there, so that their twist is 0 at it.
  Unknowns Draw() {
    std::mt19937 random(static_cast<unsigned>(GetParam()));
    Unknowns x;
    for (double& each : x) each = 0.4 * (static_cast<double>(random()) / 4294967295.0 - 0.5);
    x[4] += 1.0, x[8] += 2.0;
    return x;
  }
  static Vec3 At(const Unknowns& x, std::size_t first) { return {x[first], x[first + 1], x[first + 2]}; }

  /// Twist of the references at x that follow from `base` without turning about their segments.
  static double ReferenceTwist(const Unknowns& base, const Unknowns& x) {
    const auto direction = [](const Unknowns& at, std::size_t segment) {
      return math::Normalized(At(at, 4 * segment + 4) - At(at, 4 * segment));
    };
    const Vec3 u1 = math::AnyPerpendicular(direction(base, 0));
    const Vec3 u2 = Transport(u1, direction(base, 0), direction(base, 1));
    const Vec3 v1 = Transport(u1, direction(base, 0), direction(x, 0)),
               v2 = Transport(u2, direction(base, 1), direction(x, 1));
    return CalcSignedAngle(Transport(v1, direction(x, 0), direction(x, 1)), v2, direction(x, 1));
  }

  static ElementDerivatives Derive(const Unknowns& base, const Unknowns& x) {
    ElementDerivatives sum;
    AddJoint({At(x, 4) - At(x, 0), At(x, 8) - At(x, 4), 0.7, 1.3, x[7] - x[3] + ReferenceTwist(base, x)},
             true, sum);
    return sum;
  }
};

// The references' twist depends on the way that they were carried, which a solve begins anew after each step: so do these.
TEST_P(JointTest, GradientIsTheEnergysDerivative) {
  Unknowns x = Draw();
  x[7] += 0.4;
  const ElementDerivatives here = Derive(x, x);
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < kElementUnknowns; ++i) {
    Unknowns up = x, down = x;
    up[i] += kStep, down[i] -= kStep;
    EXPECT_NEAR(here.gradient[i], (Derive(x, up).energy - Derive(x, down).energy) / (2 * kStep), 1e-8) << i;
  }
}

TEST_P(JointTest, StiffnessIsTheEnergysSecondDerivative) {
  Unknowns x = Draw();
  x[7] += 0.4;
  const ElementDerivatives here = Derive(x, x);
  constexpr double kStep = 1e-4;
  for (std::size_t i = 0; i < kElementUnknowns; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const auto energy = [&](double a, double b) {
        Unknowns moved = x;
        moved[i] += a * kStep, moved[j] += b * kStep;
        return Derive(x, moved).energy;
      };
      const double second =
          (energy(1, 1) - energy(1, -1) - energy(-1, 1) + energy(-1, -1)) / (4 * kStep * kStep);
      EXPECT_NEAR(here.stiffness[i][j], second, 2e-6) << i << " " << j;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Drawn, JointTest, testing::Range(1, 6));

TEST(Joint, FoldedFlatIsFiniteAndDearerThanAnythingElse) {
  ElementDerivatives flat, nearly;
  AddJoint({{1, 0, 0}, {-1, 0, 0}, 1.0, 1.0, 0.0}, true, flat);
  AddJoint({{1, 0, 0}, {-1, 0.1, 0}, 1.0, 1.0, 0.0}, true, nearly);
  EXPECT_TRUE(std::isfinite(flat.energy));
  EXPECT_GT(flat.energy, 10 * nearly.energy);
  for (const double each : flat.gradient) EXPECT_TRUE(std::isfinite(each));
}

TEST(Joint, EnergyOfAnArcIsTheContinuousRods) {
  // a quarter circle of radius 1 in many small joints: E I / 2 times its length
  constexpr int kJoints = 200;
  const double turn = 0.5 * M_PI / kJoints, length = 2.0 * std::sin(0.5 * turn);
  double energy = 0;
  for (int i = 0; i < kJoints; ++i) {
    ElementDerivatives sum;
    AddJoint({{length, 0, 0}, {length * std::cos(turn), length * std::sin(turn), 0}, 3.0 / length, 1.0, 0.0},
             false, sum);
    energy += sum.energy;
  }
  EXPECT_NEAR(energy, 0.5 * 3.0 * 0.5 * M_PI, 1e-4);
}

TEST(Transport, KeepsLengthAndAngleWithTheDirection) {
  const Vec3 from = math::Normalized({1, 2, 3}), to = math::Normalized({2, -1, 1});
  const Vec3 carried = Transport({0.3, -1, 0.5}, from, to);
  EXPECT_NEAR(math::Norm(carried), math::Norm({0.3, -1, 0.5}), 1e-12);
  EXPECT_NEAR(math::Dot(carried, to), math::Dot({0.3, -1, 0.5}, from), 1e-12);
  EXPECT_NEAR(math::Distance(Transport(from, from, to), to), 0.0, 1e-12);
}

}  // namespace
}  // namespace trocar::rod
