// SPDX-License-Identifier: Apache-2.0
#include "rod_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace trocar::rod {
namespace {

using math::Vec3;

constexpr std::size_t kNodes = 12, kUnknowns = kNodeUnknowns * kNodes;

class RodStiffnessTest : public testing::Test {
 protected:
  RodStiffnessTest() : stiffness_(kNodes), matrix_(kUnknowns * kUnknowns), is_fixed_(kUnknowns) {
    stiffness_.Clear();
    for (std::size_t row = 0; row < kUnknowns; ++row) {
      for (std::size_t column = row - std::min(row, kBandWidth - 1); column <= row; ++column) {
        const double entry = row == column ? 9.0 : Draw();
        stiffness_.At(row, column) = entry;
        Entry(row, column) = Entry(column, row) = entry;
      }
    }
  }
  double Draw() { return static_cast<double>(random_()) / 4294967295.0 - 0.5; }
  double& Entry(std::size_t row, std::size_t column) { return matrix_[row * kUnknowns + column]; }
  void Pull(const RodPoint& a, const RodPoint& b, const Vec3& along, double k) {
    stiffness_.AddPull(a, b, along, k);
    std::vector<double> u(kUnknowns);
    for (const auto& [point, sense] : {std::pair{a, 1.0}, std::pair{b, -1.0}}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        u[PositionAt(point.segment) + axis] += sense * (1.0 - point.at) * along[static_cast<int>(axis)];
        u[PositionAt(point.segment + 1) + axis] += sense * point.at * along[static_cast<int>(axis)];
      }
    }
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t j = 0; j < kUnknowns; ++j) Entry(i, j) += k * u[i] * u[j];
    }
  }

  std::mt19937 random_{5};
  RodStiffness stiffness_;
  std::vector<double> matrix_;  // the whole of it
  std::vector<std::uint8_t> is_fixed_;
};

TEST_F(RodStiffnessTest, SolvesWithPullsBetweenFarPlacesAsTheWholeMatrixWould) {
  Pull({0, 0.3}, {9, 0.8}, math::Normalized({1, 2, -1}), 50.0);
  Pull({0, 0.3}, {9, 0.8}, math::Normalized({2, -1, 0}), 1e5);
  Pull({3, 1.0}, {7, 0.0}, {0, 0, 1}, 3.0);
  is_fixed_[5] = is_fixed_[6] = is_fixed_[40] = 1;
  ASSERT_TRUE(stiffness_.Factor(is_fixed_, 1.0));
  std::vector<double> expected(kUnknowns), x(kUnknowns);
  for (std::size_t i = 0; i < kUnknowns; ++i) expected[i] = is_fixed_[i] ? 0.0 : Draw();
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns && !is_fixed_[i]; ++j) x[i] += Entry(i, j) * expected[j];
  }
  stiffness_.Solve(x);
  for (std::size_t i = 0; i < kUnknowns; ++i) EXPECT_NEAR(x[i], expected[i], 1e-9) << i;
}

TEST_F(RodStiffnessTest, WhatIsNotPositiveDefiniteIsMadeSo) {
  for (std::size_t i = 0; i < kUnknowns; ++i) stiffness_.At(i, i) = -1.0;
  stiffness_.At(0, 0) = 2.0;
  EXPECT_FALSE(stiffness_.Factor(is_fixed_, 1.0));
  std::vector<double> x(kUnknowns, 1.0);
  stiffness_.Solve(x);
  double along = 0;
  for (const double each : x) along += each;
  EXPECT_GT(along, 0.0) << "a step against the gradient goes down";
  EXPECT_TRUE(std::isfinite(along));
}

TEST_F(RodStiffnessTest, MorePullsThanThereIsRoomForAreLeftOut) {
  for (std::size_t i = 0; i < RodStiffness::kMaxPulls + 5; ++i)
    stiffness_.AddPull({0, 0}, {9, 0}, {1, 0, 0}, 1.0);
  EXPECT_TRUE(stiffness_.Factor(is_fixed_, 1.0));
  std::vector<double> x(kUnknowns, 1.0);
  stiffness_.Solve(x);
  for (const double each : x) EXPECT_TRUE(std::isfinite(each));
}

}  // namespace
}  // namespace trocar::rod
