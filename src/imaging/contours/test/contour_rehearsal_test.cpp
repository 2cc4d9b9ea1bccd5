// SPDX-License-Identifier: Apache-2.0
// A ball in pictures and labels that a simulated user clicks.
#include "trocar/contours/contour_rehearsal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "phantom_picture.h"
#include "trocar/contours/build_organs.h"
#include "trocar/contours/contour_spline.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kRadius = 24.0;  // mm
constexpr double kPixel = 0.5;    // mm
constexpr int kMiddle = 40;       // slice

ControlPoints MakeSeries() {
  ControlPoints points;
  points.name = "ball";
  points.first_slice = 0, points.last_slice = 79;
  points.width = points.height = 160;
  points.pixel_mm = kPixel, points.slice_mm = 1.0;
  points.axes = {"left", "anterior", "inferior"};
  points.structures.resize(1);
  points.structures[0].name = "ball";
  points.structures[0].triangle_budget = 2000;
  points.structures[0].reference_label = 3;
  return points;
}

double RadiusPx(int slice) {
  const double away = slice - kMiddle;
  return std::sqrt(std::max(0.0, kRadius * kRadius - away * away)) / kPixel;
}

// voxels of two pixels
images::LabelVolume MakeLabels() {
  images::LabelVolume labels;
  labels.size = {80, 80, 80};
  labels.direction = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  labels.labels.assign(80 * 80 * 80, 0);
  for (int k = 0; k < 80; ++k) {
    for (int j = 0; j < 80; ++j) {
      for (int i = 0; i < 80; ++i) {
        if (std::hypot(2 * i + 0.5 - 80, 2 * j + 0.5 - 80) < RadiusPx(k))
          labels.labels[(static_cast<std::size_t>(k) * 80 + j) * 80 + i] = 3;
      }
    }
  }
  return labels;
}

TEST(TraceLabel, FindsContoursAndHoles) {
  images::LabelVolume labels = MakeLabels();
  // a square hole in the middle slice
  for (int j = 36; j < 44; ++j) {
    for (int i = 36; i < 44; ++i) labels.labels[(static_cast<std::size_t>(kMiddle) * 80 + j) * 80 + i] = 0;
  }
  const ControlPoints series = MakeSeries();
  const auto step = FindLabelStep(labels, series);
  ASSERT_TRUE(step.ok()) << step.error().Text();
  const auto outlines = TraceLabel(labels, series, *step, 3, kMiddle);
  ASSERT_EQ(outlines.size(), 2u);
  EXPECT_NEAR(outlines[0].area_px, M_PI * 48 * 48, 60);
  EXPECT_NEAR(outlines[0].length_px, 2 * M_PI * 48, 8);
  for (const Vec2& p : outlines[0].points) EXPECT_NEAR(Norm(p - Vec2{80, 80}), 48, 1.0);
  EXPECT_NEAR(outlines[1].area_px, -256, 30);
  EXPECT_NEAR(DistanceToOutlines({80, 80}, outlines), 8.0, 0.6);
  EXPECT_TRUE(TraceLabel(labels, series, *step, 3, 2).empty());
  EXPECT_TRUE(TraceLabel(labels, series, *step, 4, kMiddle).empty());
}

TEST(SimulateClicks, MissByExactlyTheNoiseAndNeverCross) {
  Outline circle;
  circle.points = MakePolar({80, 80}, 720, [](double) { return 48.0; });
  math::Random random(5);
  double inwards = 0;
  for (int i = 0; i < 200; ++i) {
    const auto clicks = SimulateClicks(circle, 10, 6.0, MakeSeries(), random);
    ASSERT_EQ(clicks.size(), 10u);
    EXPECT_FALSE(CrossesItself(clicks));
    for (const Vec2& p : clicks) {
      EXPECT_LE(std::fabs(Norm(p - Vec2{80, 80}) - 48.0), 6.0 + 0.01);
      inwards += Norm(p - Vec2{80, 80}) < 48.0;
    }
  }
  EXPECT_NEAR(inwards / 2000, 0.48, 0.05);
}

TEST(SimulateUser, ClicksEveryNthSliceTheSameForASeed) {
  const images::LabelVolume labels = MakeLabels();
  const ControlPoints series = MakeSeries();
  const Structure a = SimulateUser(labels, series, series.structures[0], {}, 4),
                  b = SimulateUser(labels, series, series.structures[0], {}, 4),
                  c = SimulateUser(labels, series, series.structures[0], {}, 5);
  ASSERT_GE(a.slices.size(), 4u);
  for (std::size_t i = 1; i < a.slices.size(); ++i) EXPECT_EQ(a.slices[i].slice - a.slices[i - 1].slice, 8);
  for (const SliceContours& slice : a.slices) {
    EXPECT_GE(slice.contours[0].size(), 8u);
    EXPECT_LE(slice.contours[0].size(), 12u);
  }
  EXPECT_EQ(a.slices[1].contours, b.slices[1].contours);
  EXPECT_NE(a.slices[1].contours, c.slices[1].contours);
}

TEST(Rehearsal, AdaptionHalvesTheErrorAndRaisesTheOverlapWhereTruthIsKnown) {
  const images::LabelVolume labels = MakeLabels();
  ControlPoints series = MakeSeries();
  // every 4th slice: at 8 mm the caps of so small a ball are what is lost
  series.structures[0] = SimulateUser(labels, series, series.structures[0], {.every = 4}, 2);
  std::map<int, images::ColorImage> images;
  for (const SliceContours& slice : series.structures[0].slices) {
    images[slice.slice] =
        DrawPhantom({.seed = static_cast<std::uint64_t>(slice.slice)},
                    [&](double x, double y) { return std::hypot(x - 80, y - 80) - RadiusPx(slice.slice); });
  }
  double dice[2], error[2] = {0, 0};
  for (const bool is_adapted : {false, true}) {
    ControlPoints used = series;
    used.structures[0].adaption.skipped_shift_px = 0;  // the clicked slices alone
    if (!is_adapted) used.structures[0].adaption.max_shift_px = 0;
    const auto built = BuildOrgans(used, images, {.reference = &labels});
    ASSERT_TRUE(built.ok()) << built.error().Text();
    dice[is_adapted] = built->organs[0].judgement->dice;
    for (const auto& [slice, overlay] : built->overlays) {
      for (const Vec2& p : overlay.contours[0].adapted)
        error[is_adapted] += std::fabs(Norm(p - Vec2{80, 80}) - RadiusPx(slice));
    }
  }
  EXPECT_LT(error[1], 0.25 * error[0]);
  EXPECT_GT(dice[1], 0.97);
  EXPECT_GT(dice[1], dice[0] + 0.02);
}

TEST(RehearseContours, RefusesWhatMakesNoSense) {
  RehearsalOptions options;
  options.clicks.points = {2, 1};
  EXPECT_EQ(RehearseContours(options).error().code, base::ErrorCode::kUsage);
  options.clicks.points = {8, 12};
  options.control_points = "nowhere.json";
  EXPECT_EQ(RehearseContours(options).error().code, base::ErrorCode::kFileMissing);
}

}  // namespace
}  // namespace trocar::contours
