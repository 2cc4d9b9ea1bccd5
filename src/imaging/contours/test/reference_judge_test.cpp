// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/reference_judge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/geometry/primitives.h"

namespace trocar::contours {
namespace {

constexpr double kRadius = 12.0;  // mm

ControlPoints MakeSeries() {
  ControlPoints points;
  points.first_slice = 100, points.last_slice = 149;
  points.width = 100, points.height = 80;
  points.pixel_mm = 0.5, points.slice_mm = 1.0;
  points.axes = {"left", "anterior", "inferior"};
  return points;
}

// a ball of label 3 about column 25 mm, row 20 mm, slice 125, in voxels of two pixels
images::LabelVolume MakeBall() {
  images::LabelVolume labels;
  labels.size = {50, 40, 50};
  labels.direction = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  labels.labels.assign(50 * 40 * 50, 0);
  for (int k = 0; k < 50; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 50; ++i) {
        const double away = std::hypot(i + 0.25 - 25, j + 0.25 - 20, k + 100 - 125.0);
        if (away < kRadius) labels.labels[(static_cast<std::size_t>(k) * 40 + j) * 50 + i] = 3;
      }
    }
  }
  return labels;
}

TEST(Judge, FindsTheSameBallEqual) {
  const auto judged =
      Judge(MakeBall(), MakeSeries(), 3, geometry::MakeSphere({25, 20, 125}, kRadius, 5), {0, -1});
  ASSERT_TRUE(judged.ok()) << judged.error().Text();
  EXPECT_NEAR(judged->volume_ml, 4.0 / 3.0 * M_PI * 1.728, 0.1);
  EXPECT_NEAR(judged->ratio, 1.0, 0.01);
  EXPECT_GT(judged->dice, 0.985);
}

TEST(Judge, HalvesOfABallOverlapAsTheFormulaSays) {
  // a ball moved by its radius shares 5/16 of its volume
  const auto judged =
      Judge(MakeBall(), MakeSeries(), 3, geometry::MakeSphere({25 + kRadius, 20, 125}, kRadius, 5), {0, -1});
  ASSERT_TRUE(judged.ok());
  EXPECT_NEAR(judged->dice, 5.0 / 16.0, 0.02);
}

TEST(Judge, LeavesSlicesOut) {
  // wrong from slice 126 on: a mesh of the upper half only
  const auto mesh = geometry::MakeBox({10, 5, 110}, {40, 35, 125.5});
  const auto all = Judge(MakeBall(), MakeSeries(), 3, mesh, {0, -1});
  const auto upper = Judge(MakeBall(), MakeSeries(), 3, mesh, {126, 149});
  ASSERT_TRUE(all.ok() && upper.ok());
  EXPECT_NEAR(upper->reference_ml, all->reference_ml / 2, 0.4);
  EXPECT_NEAR(upper->volume_ml, all->volume_ml, 1e-9);
}

TEST(Judge, RefusesLabelsOfAnotherSeries) {
  const auto mesh = geometry::MakeSphere({25, 20, 125}, kRadius, 3);
  EXPECT_EQ(Judge(MakeBall(), MakeSeries(), 4, mesh, {0, -1}).error().code, base::ErrorCode::kLabelsMismatch);
  ControlPoints longer = MakeSeries();
  longer.last_slice = 160;
  EXPECT_EQ(Judge(MakeBall(), longer, 3, mesh, {0, -1}).error().code, base::ErrorCode::kLabelsMismatch);
  ControlPoints mirrored = MakeSeries();
  mirrored.axes[0] = "right";
  EXPECT_EQ(Judge(MakeBall(), mirrored, 3, mesh, {0, -1}).error().code, base::ErrorCode::kLabelsMismatch);
}

}  // namespace
}  // namespace trocar::contours
