// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/volume_constraint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

TEST(CalcVolumeGradient, AgreesWithTheVolumeAndItsFiniteDifferences) {
  auto mesh = geometry::MakeSphere({0.4, -0.2, 0.1}, 0.02, 2);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] +=
        0.002 * Vec3{std::sin(3.0 * static_cast<double>(i)), std::cos(5.0 * static_cast<double>(i)), 0};
  }
  std::vector<Vec3> gradient(mesh.positions.size());
  const double volume = CalcVolumeGradient(mesh.positions, mesh.triangles, gradient);
  EXPECT_NEAR(volume / geometry::CalcVolume(mesh.positions, mesh.triangles), 1.0, 1e-10);
  EXPECT_NEAR(CalcClosedVolume(mesh.positions, mesh.triangles), volume, 1e-18);
  constexpr double kStep = 1e-6;
  for (const std::size_t node : {0u, 7u, 33u, 80u}) {
    for (int axis = 0; axis < 3; ++axis) {
      const double before = mesh.positions[node][axis];
      mesh.positions[node][axis] = before + kStep;
      const double up = CalcClosedVolume(mesh.positions, mesh.triangles);
      mesh.positions[node][axis] = before - kStep;
      const double down = CalcClosedVolume(mesh.positions, mesh.triangles);
      mesh.positions[node][axis] = before;
      EXPECT_NEAR(gradient[node][axis], (up - down) / (2 * kStep), 1e-9) << node;
    }
  }
}

// Pressure on a closed surface neither pushes nor turns it.
TEST(CalcVolumeGradient, HasNoNetForceOrTorque) {
  const auto mesh = geometry::MakeSphere({1.0, 2.0, 3.0}, 0.02, 3);
  std::vector<Vec3> gradient(mesh.positions.size());
  (void)CalcVolumeGradient(mesh.positions, mesh.triangles, gradient);
  Vec3 force, torque;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    force += gradient[i];
    torque += math::Cross(mesh.positions[i] - Vec3{1, 2, 3}, gradient[i]);
  }
  EXPECT_LT(math::Norm(force), 1e-15);
  EXPECT_LT(math::Norm(torque), 1e-17);
}

// Analytic: with V' = -C A sqrt(2 P / rho) and P = dV / c, the square root of P falls linearly in time.
TEST(CalcOutflow, FollowsTorricelliAsTheTickShrinks) {
  const double compliance = 5e-10, area = 3e-6, start = 1000.0, dt = 1e-5;
  double pressure = start;
  const double slope = kDischargeCoefficient * area * std::sqrt(2.0 / kBileDensity) / compliance / 2.0;
  double time = 0;
  for (int tick = 0; tick < 40'000; ++tick) {
    pressure -= CalcOutflow(pressure, compliance, area, kBileDensity, dt) / compliance;
    time += dt;
    if (tick % 4000 == 0 && std::sqrt(start) - slope * time > 1.0) {
      EXPECT_NEAR(std::sqrt(pressure) / (std::sqrt(start) - slope * time), 1.0, 2e-3) << tick;
    }
  }
  EXPECT_LT(pressure, 1e-3) << "it empties in " << std::sqrt(start) / slope << " s";
}

TEST(CalcOutflow, NeverTakesMoreThanThePressureHolds) {
  for (const double area : {1e-9, 1e-6, 1e-3, 1.0, 1e6}) {
    for (const double dt : {1e-6, 1.0 / 120, 10.0}) {
      const double outflow = CalcOutflow(800.0, 3e-10, area, kBileDensity, dt);
      EXPECT_GT(outflow, 0.0);
      EXPECT_LE(outflow, 3e-10 * 800.0);
    }
  }
  EXPECT_EQ(CalcOutflow(-5.0, 3e-10, 1e-6, kBileDensity, 0.01), 0.0) << "no suction";
  EXPECT_EQ(CalcOutflow(800.0, 3e-10, 0.0, kBileDensity, 0.01), 0.0) << "no hole";
  EXPECT_EQ(CalcOutflow(std::nan(""), 3e-10, 1e-6, kBileDensity, 0.01), 0.0);
}

}  // namespace
}  // namespace trocar::tissue
