// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/tone_curve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "exposure_meter.h"
#include "test_scene.h"
#include "trocar/geometry/primitives.h"

namespace trocar::render {
namespace {

using math::Vec3;

TEST(ToneCurve, RisesEverywhereAndStaysBelowWhite) {
  double before = -1;
  for (double light = 0; light < 2e4; light = 1.05 * light + 1e-4) {
    const double shown = CalcShown(light);
    EXPECT_GE(shown, before) << light;
    EXPECT_LE(shown, 1.0) << light;
    before = shown;
  }
  EXPECT_GT(before, 0.999);
  EXPECT_EQ(CalcShown(INFINITY), CalcShown(kMostLight));
}

TEST(ToneCurve, IsUndone) {
  for (const double light : {0.0, 0.001, 0.02, 0.18, 1.0, 5.0, 60.0})
    EXPECT_NEAR(CalcLightShown(CalcShown(light)), light, 1e-6 * (1 + light * light));
}

// Proportional control by hand: a picture that is half as bright wants nearly twice the exposure.
TEST(ExposureMeter, AsksForMoreInTheDarkAndLessInTheLight) {
  const auto grey = [](double light) {
    const auto byte = static_cast<std::uint8_t>(std::lround(255 * CalcShown(light)));
    return std::vector<std::uint8_t>(4 * 100, byte);
  };
  const double middle = CalcWantedExposure(grey(0.17), 1.0);
  EXPECT_NEAR(middle, 1.0, 0.02);
  EXPECT_NEAR(CalcWantedExposure(grey(0.085), 1.0), std::pow(2.0, 0.75), 0.05);
  // the same scene through any exposure wants the same
  EXPECT_NEAR(CalcWantedExposure(grey(0.34), 2.0), middle, 0.02);
  EXPECT_EQ(CalcWantedExposure(grey(1e4), 1.0), kLeastExposure);
  EXPECT_EQ(CalcWantedExposure(grey(0.002), 1.0), kMostExposure);
  EXPECT_EQ(CalcWantedExposure(grey(0), 1.3), 1.3) << "black tells nothing";
  auto half = grey(0.17);
  const auto black = grey(0);
  half.insert(half.end(), black.begin(), black.end());
  EXPECT_EQ(CalcWantedExposure(half, 1.0), middle) << "nor does what is drawn nowhere darken the rest";
  // a few burnt-out pixels hold it back
  std::vector<std::uint8_t> spotted = grey(0.17);
  std::fill_n(spotted.begin(), 4 * 10, std::uint8_t{250});
  EXPECT_LT(CalcWantedExposure(spotted, 1.0), 0.9);
}

class ToneTest : public DrawingTest {
 protected:
  /// A wet ball that fills the picture.
  Frame BallFrame(Material material, double distance) {
    Frame frame = PlainFrame();
    const SurfaceId ball = renderer_->AddSurface(geometry::MakeSphere({0, 0, 0}, 0.03, 5), material);
    frame.surfaces = {{ball, {{}, {0, 0, -distance - 0.03}}}};
    frame.quality = Quality::kLow;
    return frame;
  }
};

// The fault that there was: more light made a highlight grey, and then black.
TEST_F(ToneTest, MoreLightDarkensNoPixelInAnyChannel) {
  for (const Material material :
       {Material::kLiver, Material::kFat, Material::kGallbladder, Material::kSteel}) {
    Frame frame = BallFrame(material, 0.05);
    Image before;
    for (double exposure = 0.1; exposure < 2000; exposure *= 3) {
      frame.exposure = exposure;
      const Image now = Draw(frame);
      for (std::size_t i = 0; i < before.pixels.size(); ++i)
        ASSERT_GE(now.pixels[i] + 1, before.pixels[i]) << "exposure " << exposure << ", byte " << i;
      before = now;
    }
    const auto [r, g, b] = before.At(kWidth / 2, kHeight / 2);
    EXPECT_GT(std::min({r, g, b}), 250) << "white in the end";
  }
}

TEST_F(ToneTest, GlowOnlyBrightensAndNeverBeyondWhite) {
  Frame frame = BallFrame(Material::kLiver, 0.02);
  frame.has_smooth_edges = true;
  frame.exposure = 3;
  const Image plain = Draw(frame);
  frame.quality = Quality::kHigh;
  const Image glowing = Draw(frame);
  int brighter = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) brighter += Brightness(glowing, x, y) > Brightness(plain, x, y) ? 1 : 0;
  }
  EXPECT_GT(brighter, 100);
  const auto [r, g, b] = glowing.At(kWidth / 2, kHeight / 2);
  EXPECT_GT(std::min({r, g, b}), 200);
}

TEST_F(ToneTest, AutomaticExposureShowsNearAndFarAlike) {
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (const std::uint8_t byte : image.pixels) sum += byte;
    return sum / static_cast<double>(image.pixels.size());
  };
  const SurfaceId plate = renderer_->AddSurface(geometry::MakeGrid(60, 0.01), Material::kBowel);
  const auto draw_at = [&](double distance, double time, bool is_automatic) {
    Frame frame = PlainFrame();
    frame.surfaces = {{plate, {{}, {-0.3, -0.3, -distance}}}};
    frame.time = time;
    frame.has_automatic_exposure = is_automatic;
    return Draw(frame);
  };
  const double near_before = mean(draw_at(0.08, 0, false)), far_before = mean(draw_at(0.16, 0, false));
  const Image first = draw_at(0.08, 0, true);
  const double near_after = mean(first);
  EXPECT_EQ(first, draw_at(0.08, 0, true)) << "the same moment, the same pixels";
  const double late = mean(draw_at(0.16, 0.02, true));
  double settled = 0;
  for (int i = 0; i < 120; ++i) settled = mean(draw_at(0.16, 0.02 + 0.02 * i, true));
  EXPECT_GT(near_before / far_before, 1.25) << "without it";
  EXPECT_LT(near_after / settled, 1.2);
  EXPECT_LT(late, 0.9 * settled) << "it takes a moment";
  // a leap finds its exposure at once
  EXPECT_NEAR(mean(draw_at(0.16, 100, true)), settled, 3.0);
}

}  // namespace
}  // namespace trocar::render
