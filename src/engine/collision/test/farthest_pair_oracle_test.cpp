// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/farthest_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "trocar/collision/brute_force.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::collision {

using math::Vec3;

namespace {

std::vector<std::uint32_t> AllOf(std::span<const Vec3> points) {
  std::vector<std::uint32_t> members(points.size());
  std::iota(members.begin(), members.end(), 0u);
  return members;
}

void ExpectSameAsBruteForce(std::span<const Vec3> points, std::span<const std::uint32_t> members) {
  const FarthestPair fast = FindFarthestPair(points, members),
                     oracle = FindFarthestPairBruteForce(points, members);
  EXPECT_EQ(fast.first, oracle.first);
  EXPECT_EQ(fast.second, oracle.second);
  EXPECT_EQ(fast.squared_distance, oracle.squared_distance);
}

TEST(FindFarthestPair, FindsTheDiagonalOfABoxOfPoints) {
  std::vector<Vec3> points;
  for (int x = 0; x < 5; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 3; ++z) points.push_back({x * 0.01, y * 0.01, z * 0.01});
    }
  }
  const FarthestPair pair = FindFarthestPair(points, AllOf(points));
  EXPECT_NEAR(pair.squared_distance, 29e-4, 1e-15);
  // four diagonals are equally far; the one from the lowest index counts
  EXPECT_EQ(pair.first, 0u);
  EXPECT_EQ(pair.second, 59u);
}

TEST(FindFarthestPair, AgreesWithBruteForceOnRandomClouds) {
  math::Random random(3);
  for (const int count : {2, 3, 47, 48, 49, 50, 100, 333, 1500}) {
    for (int trial = 0; trial < 5; ++trial) {
      SCOPED_TRACE(testing::Message() << count << " points, trial " << trial);
      std::vector<Vec3> points;
      const Vec3 size{random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 0.01)};
      for (int i = 0; i < count; ++i) {
        points.push_back({size.x * random.Uniform(), size.y * random.Uniform(), size.z * random.Uniform()});
      }
      ExpectSameAsBruteForce(points, AllOf(points));
    }
  }
}

TEST(FindFarthestPair, AgreesWithBruteForceWhereMostPairsTie) {
  const std::function<Vec3(int)> shapes[] = {
      [](int) {
        return Vec3{0.1, 0.2, 0.3};
      },  // all the same point
      [](int i) {
        return Vec3{i % 2 == 0 ? 0.0 : 1.0, 0, 0};
      },  // two points
      [](int i) {
        return Vec3{double(i % 7), double(i % 5), 0};
      },  // a lattice, many times over
      [](int i) {
        return Vec3{0.001 * i, 0, 0};
      },  // a line
      [](int i) {
        return Vec3{std::cos(i * 0.0174533), std::sin(i * 0.0174533), 0};
      },  // a circle
  };
  for (std::size_t shape = 0; shape < std::size(shapes); ++shape) {
    SCOPED_TRACE(shape);
    std::vector<Vec3> points;
    for (int i = 0; i < 720; ++i) points.push_back(shapes[shape](i));
    ExpectSameAsBruteForce(points, AllOf(points));
  }
}

// A sphere is the hardest case for a bound: every point has an antipode.
TEST(FindFarthestPair, AgreesWithBruteForceOnASphere) {
  const geometry::TriangleMesh sphere = geometry::MakeSphere({0.1, -0.2, 0.05}, 0.07, 4);
  ExpectSameAsBruteForce(sphere.positions, AllOf(sphere.positions));
}

TEST(FindFarthestPair, LooksOnlyAtItsMembers) {
  math::Random random(5);
  std::vector<Vec3> points;
  std::vector<std::uint32_t> members;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const bool member = i % 3 != 0;
    const double reach = member ? 1.0 : 100.0;
    points.push_back(
        {random.Uniform(-reach, reach), random.Uniform(-reach, reach), random.Uniform(-reach, reach)});
    if (member) members.push_back(i);
  }
  ExpectSameAsBruteForce(points, members);
  EXPECT_LT(FindFarthestPair(points, members).squared_distance, 12.01);
}

}  // namespace
}  // namespace trocar::collision
