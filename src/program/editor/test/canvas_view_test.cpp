// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/canvas_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/math/random.h"

namespace trocar::editor {

using math::Vec2;

namespace {

constexpr CanvasSize kSize{900, 650};

TEST(CanvasView, MapsThereAndBack) {
  math::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const CanvasView view{0.1 + 20 * random.Uniform(),
                          {1280 * random.Uniform(), 720 * random.Uniform()},
                          random.Uniform() < 0.5,
                          random.Uniform() < 0.5};
    const Vec2 p{1280 * random.Uniform(), 720 * random.Uniform()};
    const Vec2 back = ToPicture(view, kSize, ToCanvas(view, kSize, p));
    EXPECT_NEAR(back.x, p.x, 1e-9);
    EXPECT_NEAR(back.y, p.y, 1e-9);
  }
}

TEST(CanvasView, ZoomKeepsWhatLiesUnderThePointer) {
  CanvasView view{1.3, {300, 200}, true, false};
  const Vec2 at{123, 456};
  const Vec2 under = ToPicture(view, kSize, at);
  for (int i = 0; i < 100; ++i) ZoomAt(view, kSize, at, i < 50 ? 1.2 : 0.7);
  EXPECT_EQ(view.zoom, kLeastZoom);
  const Vec2 now = ToPicture(view, kSize, at);
  EXPECT_NEAR(now.x, under.x, 1e-9);
  EXPECT_NEAR(now.y, under.y, 1e-9);
  ZoomAt(view, kSize, at, 1e9);
  EXPECT_EQ(view.zoom, kMostZoom);
}

TEST(CanvasView, PanMovesThePictureWithThePointerEvenMirrored) {
  for (const bool is_mirrored : {false, true}) {
    CanvasView view{2, {500, 300}, is_mirrored, is_mirrored};
    const Vec2 p{520, 310};
    const Vec2 before = ToCanvas(view, kSize, p);
    PanBy(view, 30, -14, 1280, 720);
    const Vec2 after = ToCanvas(view, kSize, p);
    EXPECT_NEAR(after.x - before.x, 30, 1e-9);
    EXPECT_NEAR(after.y - before.y, -14, 1e-9);
    for (int i = 0; i < 100; ++i) PanBy(view, 500, 500, 1280, 720);
    const Vec2 middle = ToPicture(view, kSize, {450, 325});
    EXPECT_GE(middle.x, 0);
    EXPECT_LE(middle.x, 1279);
  }
}

TEST(CanvasView, FitShowsTheWholePicture) {
  CanvasView view;
  FitPicture(view, kSize, 1280, 720);
  const Vec2 low = ToCanvas(view, kSize, {-0.5, -0.5}), high = ToCanvas(view, kSize, {1279.5, 719.5});
  EXPECT_GT(low.x, 0);
  EXPECT_LT(low.x, 30);
  EXPECT_NEAR(low.x, 900 - high.x, 1e-9);
  EXPECT_GT(low.y, 0);
  EXPECT_LT(high.y, 650);
}

TEST(CanvasView, RadiologyPutsAnteriorAboveAndTheRightAtTheLeft) {
  CanvasView view;
  MirrorForRadiology(view, {"left", "anterior", "inferior"});
  EXPECT_FALSE(view.is_mirrored_x);
  EXPECT_TRUE(view.is_mirrored_y);
  for (const auto& axes : {std::array<std::string, 3>{"left", "posterior", "superior"},
                           std::array<std::string, 3>{"right", "anterior", "superior"},
                           std::array<std::string, 3>{"right", "posterior", "inferior"}}) {
    MirrorForRadiology(view, axes);
    const EdgeLetters letters = FindEdgeLetters(view, axes);
    EXPECT_EQ(letters.left, "R");
    EXPECT_EQ(letters.right, "L");
    EXPECT_EQ(letters.top, "A");
    EXPECT_EQ(letters.bottom, "P");
  }
  const std::array<std::string, 3> sagittal{"anterior", "inferior", "left"};
  MirrorForRadiology(view, sagittal);
  const EdgeLetters letters = FindEdgeLetters(view, sagittal);
  EXPECT_EQ(letters.left, "A");
  EXPECT_EQ(letters.top, "S");
  view.is_mirrored_x = view.is_mirrored_y = false;
  EXPECT_EQ(FindEdgeLetters(view, sagittal).left, "P");
}

TEST(CanvasView, HitsTheNearestPointWithinReach) {
  const CanvasView view{4, {50, 50}};
  const std::vector<Vec2> points = {{50, 50}, {52, 50}, {80, 80}};
  const Vec2 at = ToCanvas(view, kSize, {51.5, 50});
  EXPECT_EQ(HitPoint(view, kSize, points, at, 9), 1u);
  EXPECT_EQ(HitPoint(view, kSize, points, ToCanvas(view, kSize, {60, 60}), 9), std::nullopt);
  // reach is of the screen: the same place is too far away when zoomed in
  const CanvasView near{20, {50, 50}};
  EXPECT_EQ(HitPoint(near, kSize, points, ToCanvas(near, kSize, {51.2, 50}), 9), std::nullopt);
}

TEST(CanvasView, HitsACurveAndKnowsBetweenWhichPoints) {
  // a curve of 400 points through 8 control points of a circle, beginning between two of them
  std::vector<Vec2> curve, controls;
  for (int i = 0; i < 400; ++i) {
    const double a = 2 * M_PI * (i + 180) / 400;
    curve.push_back({100 + 40 * std::cos(a), 100 + 40 * std::sin(a)});
  }
  for (int i = 0; i < 8; ++i) {
    const double a = 2 * M_PI * i / 8;
    controls.push_back({100 + 40 * std::cos(a), 100 + 40 * std::sin(a)});
  }
  const CanvasView view{3, {100, 100}};
  for (int i = 0; i < 8; ++i) {
    const double a = 2 * M_PI * (i + 0.5) / 8;
    const Vec2 between{100 + 40.5 * std::cos(a), 100 + 40.5 * std::sin(a)};
    const auto hit = HitCurve(view, kSize, curve, ToCanvas(view, kSize, between), 9);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->distance, 1.5, 0.05);
    EXPECT_NEAR(Norm(hit->at - Vec2{100, 100}), 40, 0.01);
    EXPECT_EQ(FindInsertion(curve, controls, hit->side), static_cast<std::size_t>(i) + 1);
  }
  EXPECT_FALSE(HitCurve(view, kSize, curve, ToCanvas(view, kSize, {100, 100}), 9).has_value());
}

TEST(CanvasView, ScaleBarsAreRound) {
  EXPECT_EQ(ChooseScaleBar(1, 0.528, 130), 50);
  EXPECT_EQ(ChooseScaleBar(4, 0.528, 130), 10);
  EXPECT_EQ(ChooseScaleBar(40, 0.528, 130), 1);
}

}  // namespace
}  // namespace trocar::editor
