// SPDX-License-Identifier: Apache-2.0
#include "volume_opening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace trocar::contours {
namespace {

using math::Vec3;

/// \param distance  signed, > 0 inside [mm]
meshing::ScalarVolume Sample(double spacing, double half, const std::function<double(Vec3)>& distance) {
  meshing::ScalarVolume volume;
  volume.spacing = spacing;
  const int reach = static_cast<int>(std::ceil(half / spacing));
  volume.first = {-reach, -reach, -reach};
  volume.size = {2 * reach + 1, 2 * reach + 1, 2 * reach + 1};
  for (int k = 0; k < volume.size[2]; ++k)
    for (int j = 0; j < volume.size[1]; ++j)
      for (int i = 0; i < volume.size[0]; ++i)
        volume.values.push_back(static_cast<float>(distance(volume.Position(i, j, k))));
  return volume;
}

double At(const meshing::ScalarVolume& volume, Vec3 place) {
  const auto index = [&](double x, int axis) {
    return static_cast<int>(std::lround(x / volume.spacing)) - volume.first[static_cast<std::size_t>(axis)];
  };
  return volume.values[volume.Index(index(place.x, 0), index(place.y, 1), index(place.z, 2))];
}

double InBall(Vec3 place, double radius) {
  return radius - math::Norm(place);
}

/// A plate 6 mm thick through the origin, slanted against the slices so that it is 8.5 mm thick within each.
double InPlate(Vec3 place) {
  return 3.0 - std::fabs((place.y + place.z) / std::sqrt(2.0));
}

TEST(OpenVolume, TakesAThinPlateOffABallThatIsSlantedAgainstTheSlices) {
  auto volume = Sample(1.0, 30, [](Vec3 place) { return std::max(InBall(place, 14), InPlate(place)); });
  ASSERT_GT(At(volume, {26, 0, 0}), 0);
  OpenVolume(volume, 5);
  EXPECT_LT(At(volume, {26, 0, 0}), 0);
  EXPECT_LT(At(volume, {0, 16, -16}), 0);
  // the ball is thick everywhere and stays to the sample
  for (int k = -13; k <= 13; ++k)
    for (int j = -13; j <= 13; ++j)
      for (int i = -13; i <= 13; ++i) {
        const Vec3 place(i, j, k);
        if (InBall(place, 14) > 0) EXPECT_GT(At(volume, place), 0) << i << " " << j << " " << k;
      }
}

TEST(OpenVolume, LeavesWhatIsThickBitByBit) {
  const auto before = Sample(1.0, 20, [](Vec3 place) { return InBall(place, 12.3); });
  auto volume = before;
  OpenVolume(volume, 5);
  for (std::size_t i = 0; i < before.values.size(); ++i)
    if (std::fabs(before.values[i]) < 1) EXPECT_EQ(volume.values[i], before.values[i]);
}

TEST(OpenVolume, KeepsWhatNoBallFitsInAndWhatTheLatticeCannotTell) {
  const auto plate = Sample(1.0, 20, InPlate);
  auto volume = plate;
  OpenVolume(volume, 5);
  EXPECT_EQ(volume.values, plate.values);
  volume = plate;
  OpenVolume(volume, 1.9);
  EXPECT_EQ(volume.values, plate.values);
}

TEST(OpenVolume, AgreesWithEveryBallTried) {
  const double radius = 4;
  // an egg with a horn
  const auto shape = [](Vec3 place) {
    const double horn = 2.6 - std::hypot(place.y, place.z) - std::max(0.0, std::fabs(place.x) - 17);
    return std::max(InBall({0.7 * place.x, place.y, place.z}, 9), horn);
  };
  const auto before = Sample(1.0, 20, shape);
  auto volume = before;
  OpenVolume(volume, radius);
  const auto is_within = [&](Vec3 centre, double reach) {  // of the lattice's samples
    for (int k = -5; k <= 5; ++k)
      for (int j = -5; j <= 5; ++j)
        for (int i = -5; i <= 5; ++i)
          if (math::Norm(Vec3(i, j, k)) < reach && At(before, centre + Vec3(i, j, k)) <= 0) return false;
    return true;
  };
  int taken = 0;
  for (int k = -10; k <= 10; k += 2)
    for (int j = -10; j <= 10; j += 2)
      for (int i = -14; i <= 14; ++i) {
        const Vec3 place(i, j, k);
        if (At(before, place) <= 0) continue;
        bool is_reached = false, is_nearly_reached = false;
        for (int c = -6; c <= 6; ++c)
          for (int b = -6; b <= 6; ++b)
            for (int a = -6; a <= 6; ++a) {
              const Vec3 off(a, b, c);
              if (math::Norm(off) > radius + 2) continue;
              if (math::Norm(off) < radius && is_within(place + off, radius + 0.5)) is_reached = true;
              if (is_within(place + off, radius)) is_nearly_reached = true;
            }
        if (is_reached) EXPECT_GT(At(volume, place), 0) << i << " " << j << " " << k;
        if (!is_nearly_reached) EXPECT_LE(At(volume, place), 0) << i << " " << j << " " << k;
        taken += At(volume, place) <= 0 ? 1 : 0;
      }
  EXPECT_GT(taken, 5);
}

TEST(CalcEdgeLength, OfABallInEvenTriangles) {
  const auto volume = Sample(0.5, 20, [](Vec3 place) { return InBall(place, 15); });
  const double area = 4 * M_PI * 15 * 15;
  const double edge = CalcEdgeLength(volume, 2000);
  EXPECT_NEAR(edge * edge * std::sqrt(3.0) / 4 * 2000, area, 0.02 * area);
}

}  // namespace
}  // namespace trocar::contours
