// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/rest_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "test_systems.h"
#include "trocar/math/random.h"

namespace trocar::tissue {

using math::Pose;
using math::Quaternion;
using math::Vec3;

namespace {

std::vector<Vec3> RandomPoints(math::Random& random, int count, const Vec3& extent) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({random.Uniform(-1, 1) * extent.x, random.Uniform(-1, 1) * extent.y,
                      random.Uniform(-1, 1) * extent.z});
  }
  return points;
}

Quaternion RandomRotation(math::Random& random) {
  const Vec3 axis =
      math::Normalized(Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
  return math::RotationAbout(axis, random.Uniform(-M_PI, M_PI));
}

/// Angle between two rotations [rad].
double Angle(const Quaternion& a, const Quaternion& b) {
  const Quaternion d = math::Inverse(a) * b;
  return 2.0 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
}

Pose Fit(const std::vector<double>& weights, const std::vector<Vec3>& rest, const std::vector<Vec3>& now,
         const Quaternion& previous) {
  MotionMoments moments;
  for (std::size_t i = 0; i < rest.size(); ++i) moments.AddPoint(weights[i], rest[i], now[i]);
  return FitRigidMotion(moments, previous);
}

TEST(FitRigidMotion, RecoversAnyRigidMotionFarFromTheOrigin) {
  math::Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    auto rest = RandomPoints(random, 4 + trial % 7, {0.05, 0.03, 0.02});
    for (Vec3& r : rest) r += Vec3{10, -20, 5};
    const Pose truth{RandomRotation(random), {random.Uniform(-1, 1), 2, 3}};
    std::vector<Vec3> now;
    std::vector<double> weights;
    for (const Vec3& r : rest) now.push_back(truth * r), weights.push_back(random.Uniform(0.1, 5.0));
    // the prior of the last rotation fades when the fit repeats
    Pose fit = Fit(weights, rest, now, {});
    for (int i = 0; i < 3; ++i) fit = Fit(weights, rest, now, fit.rotation);
    EXPECT_LT(Angle(fit.rotation, truth.rotation), 1e-7) << trial;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_LT(math::Distance(fit * rest[i], now[i]), 1e-8) << trial;
    }
  }
}

// Oracle: no nearby rigid motion fits noisy points better, and the springs of the fit exert neither force nor
// torque.
TEST(FitRigidMotion, IsTheBestFitAndLeavesNoNetForceOrTorque) {
  math::Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const auto rest = RandomPoints(random, 12, {0.04, 0.02, 0.03});
    const Pose truth{RandomRotation(random), {0.1, 0, 0}};
    std::vector<Vec3> now;
    std::vector<double> weights;
    const auto noise = RandomPoints(random, 12, {0.01, 0.01, 0.01});
    for (std::size_t i = 0; i < rest.size(); ++i) {
      now.push_back(truth * rest[i] + noise[i]);
      weights.push_back(random.Uniform(0.1, 2.0));
    }
    Pose fit = Fit(weights, rest, now, truth.rotation);
    for (int i = 0; i < 4; ++i) fit = Fit(weights, rest, now, fit.rotation);
    const auto error = [&](const Pose& X) {
      double sum = 0;
      for (std::size_t i = 0; i < rest.size(); ++i)
        sum += weights[i] * math::SquaredDistance(X * rest[i], now[i]);
      return sum;
    };
    Vec3 force, torque;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Vec3 f = weights[i] * (fit * rest[i] - now[i]);
      force += f;
      torque += math::Cross(now[i] - now[0], f);
    }
    EXPECT_LT(math::Norm(force), 1e-12);
    EXPECT_LT(math::Norm(torque), 1e-9);
    for (int other = 0; other < 20; ++other) {
      const Vec3 axis =
          math::Normalized(Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
      const Quaternion turned = math::RotationAbout(axis, random.Uniform(-0.1, 0.1)) * fit.rotation;
      EXPECT_LE(error(fit), error({turned, fit.translation}) + 1e-12);
    }
  }
}

TEST(FitRigidMotion, KeepsThePreviousTurnWhereThePointsLeaveItOpen) {
  const Quaternion before = math::RotationAbout({0, 0, 1}, 0.7);
  // a lone point
  EXPECT_LT(Angle(Fit({1.0}, {{1, 2, 3}}, {{4, 5, 6}}, before).rotation, before), 1e-9);
  // a line along z, still along z: its turn about z is open
  const std::vector<Vec3> line{{0, 0, 0}, {0, 0, 0.01}, {0, 0, 0.03}};
  EXPECT_LT(Angle(Fit({1, 1, 1}, line, line, before).rotation, before), 1e-6);
  // nothing at all
  EXPECT_EQ(FitRigidMotion({}, before).rotation, before);
}

// A flat piece that passes through its own mirror image: the fit may not jump while the shape moves a little.
TEST(FitRigidMotion, IsContinuousWhileAPieceIsPressedFlatAndInsideOut) {
  const std::vector<Vec3> rest{{0.03, 0, 0},  {-0.03, 0, 0}, {0, 0.02, 0},
                               {0, -0.02, 0}, {0, 0, 0.01},  {0, 0, -0.01}};
  const std::vector<double> weights(rest.size(), 1.0);
  Quaternion last;
  for (int step = 0; step <= 400; ++step) {
    const double squash = 1.0 - 0.005 * step;  // 1 to -1
    std::vector<Vec3> now;
    for (const Vec3& r : rest) now.push_back({r.x, r.y, squash * r.z});
    const Pose fit = Fit(weights, rest, now, last);
    EXPECT_LT(Angle(fit.rotation, last), 0.02) << step;
    last = fit.rotation;
  }
}

/// Two lattices, one fixed, joined by two strands; the second is free when both are cut.
TissueDefinition TwoPatches() {
  const auto mesh = geometry::MakeGrid(3, 0.01);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 1e4);
  const auto upper = MakeMembrane(mesh, 100.0, 1e4);
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  for (std::size_t i = 0; i < upper.rest.size(); ++i) {
    definition.rest.push_back(upper.rest[i] + Vec3{0, 0, 0.002});
    definition.mass.push_back(upper.mass[i]);
    definition.shape_stiffness.push_back(upper.shape_stiffness[i]);
  }
  for (Spring spring : upper.springs) {
    spring.a += first, spring.b += first;
    definition.springs.push_back(spring);
  }
  definition.fixed = {0, 1};
  definition.strands = {{0, first, 5.0}, {4, first + 4, 5.0}};
  return definition;
}

TEST(FindFreeRegions, AnAttachedOrganIsPinnedAndACutOneIsFree) {
  const TissueModel model = MakeTissueModel(TwoPatches());
  TissueState state = MakeRestState(model);
  FreeRegions regions;
  regions.of_node.resize(model.Size());
  FindFreeRegions(model, state.strand_is_intact, {}, {}, regions);
  EXPECT_EQ(regions.count, 0u);
  state.strand_is_intact[0] = 0;
  FindFreeRegions(model, state.strand_is_intact, {}, {}, regions);
  EXPECT_EQ(regions.count, 0u) << "one strand still holds";
  state.strand_is_intact[1] = 0;
  FindFreeRegions(model, state.strand_is_intact, {}, {}, regions);
  EXPECT_EQ(regions.count, 1u);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(regions.of_node[i], kPinnedRegion);
  for (std::uint32_t i = 9; i < 18; ++i) EXPECT_EQ(regions.of_node[i], 0u);
}

TEST(FindFreeRegions, AJointDoesNotPinAndTornSpringsSplit) {
  const TissueModel model = MakeTissueModel(TwoPatches());
  const TissueState state = MakeRestState(model);
  FreeRegions regions;
  regions.of_node.resize(model.Size());
  const std::vector<std::uint8_t> joints(model.strand_count, 0);
  FindFreeRegions(model, state.strand_is_intact, joints, {}, regions);
  EXPECT_EQ(regions.count, 1u);
  // tear node 17 off
  std::vector<double> factor(model.SpringCount(), 1.0);
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      if (model.half_springs[h].other == 17) factor[model.half_springs[h].spring] = 0.0;
    }
  }
  FindFreeRegions(model, state.strand_is_intact, joints, factor, regions);
  EXPECT_EQ(regions.count, 2u);
  EXPECT_EQ(regions.of_node[17], 1u);
  EXPECT_EQ(regions.of_node[16], 0u);
}

TEST(FindFreeRegions, PiecesBeyondTheRoomStayPinnedAndAreCounted) {
  TissueDefinition definition;
  for (std::uint32_t i = 0; i < kMaxFreeRegions + 5; ++i) {
    definition.rest.push_back({0.01 * i, 0, 0});
    definition.mass.push_back(1e-3);
    definition.shape_stiffness.push_back(1.0);
  }
  const TissueModel model = MakeTissueModel(definition);
  FreeRegions regions;
  regions.of_node.resize(model.Size());
  FindFreeRegions(model, {}, {}, {}, regions);
  EXPECT_EQ(regions.count, kMaxFreeRegions);
  EXPECT_EQ(regions.beyond_count, 5u);
  EXPECT_EQ(regions.of_node.back(), kPinnedRegion);
}

}  // namespace
}  // namespace trocar::tissue
