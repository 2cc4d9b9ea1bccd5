// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/picture_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/render/image.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::view {
namespace {

using render::Image;

double Luma(const Image& image, int x, int y) {
  const auto [r, g, b] = image.At(x, y);
  return 0.299 * r + 0.587 * g + 0.114 * b;
}

/// Pixels that are clearly darker than the white all round them: what an overflow of the film curve left.
int CountHoles(const Image& image) {
  constexpr int kRing = 3;
  int holes = 0;
  for (int y = kRing; y < image.height - kRing; ++y) {
    for (int x = kRing; x < image.width - kRing; ++x) {
      if (Luma(image, x, y) > 190) continue;
      bool is_ringed = true;
      for (int i = 0; i < 16 && is_ringed; ++i) {
        const double angle = 2 * M_PI * i / 16;
        is_ringed = Luma(image, x + static_cast<int>(std::lround(kRing * std::cos(angle))),
                         y + static_cast<int>(std::lround(kRing * std::sin(angle)))) > 225;
      }
      holes += is_ringed ? 1 : 0;
    }
  }
  return holes;
}

struct Exposure {
  double mean = 0, burnt = 0;  // of the circle: mean brightness [0 to 255], share that is nearly white
};

Exposure Measure(const Image& image) {
  Exposure exposure;
  int all = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (std::hypot(x - 0.5 * image.width, y - 0.5 * image.height) > 0.5 * image.height) continue;
      exposure.mean += Luma(image, x, y);
      exposure.burnt += Luma(image, x, y) > 248 ? 1 : 0;
      ++all;
    }
  }
  exposure.mean /= all;
  exposure.burnt /= all;
  return exposure;
}

class PictureSeriesTest : public testing::Test {
 protected:
  Image Make(const std::string& name, double light_power = 1, bool is_automatic = true) {
    SeriesOptions options;
    options.output = folder_.Path();
    options.moments = folder_.Path() / "moments";
    options.only = name;
    options.width = 320, options.height = 180;
    options.view.light_power = light_power;
    options.view.has_automatic_exposure = is_automatic;
    const auto made = MakePictureSeries(options);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().Text());
    const auto bytes = host::ReadFile(folder_.Path() / (name + ".png"));
    EXPECT_TRUE(bytes.ok());
    return *render::ParsePng(*bytes, name);
  }

  test::TemporaryFolder folder_;
};

TEST(PictureSeries, HasAPictureOfEachTaskWithDifferentNames) {
  std::set<std::string> names, tasks;
  for (const SeriesSitting& sitting : ListPictureSeries()) {
    tasks.insert(sitting.task);
    for (const SeriesShot& shot : sitting.shots) names.insert(shot.name);
  }
  EXPECT_EQ(names.size(), 23u);
  EXPECT_GE(tasks.size(), 11u) << "the operation and the training tasks";
}

TEST_F(PictureSeriesTest, IsWellExposedWithoutHolesInHighlights) {
  for (const char* name : {"01-preparation", "16-peg-transfer"}) {
    const Image image = Make(name);
    const Exposure exposure = Measure(image);
    EXPECT_GT(exposure.mean, 60) << name;
    EXPECT_LT(exposure.mean, 165) << name;
    EXPECT_LT(exposure.burnt, 0.06) << name;
    EXPECT_EQ(CountHoles(image), 0) << name;
  }
  // negative controls: no control of exposure and a wrong lamp; a hole that somebody made
  EXPECT_LT(Measure(Make("01-preparation", 0.05, false)).mean, 60);
  Image holed = Make("01-preparation", 4.0, false);
  for (int y = 60; y < 90; ++y) {
    for (int x = 120; x < 160; ++x) {
      const bool is_hole = x > 138 && x < 141 && y > 73 && y < 76;
      for (int k = 0; k < 3; ++k)
        holed.pixels[static_cast<std::size_t>(3 * (y * holed.width + x) + k)] = is_hole ? 90 : 255;
    }
  }
  EXPECT_GT(CountHoles(holed), 0);
}

TEST_F(PictureSeriesTest, DrawsKeptMomentsAgainWithoutPlaying) {
  const Image played = Make("16-peg-transfer");
  EXPECT_TRUE(std::filesystem::exists(folder_.Path() / "moments/16-peg-transfer.state"));
  EXPECT_EQ(Make("16-peg-transfer"), played);
}

TEST(PictureSeries, RefusesANameThatThereIsNot) {
  SeriesOptions options;
  options.only = "21-spleen";
  const auto made = MakePictureSeries(options);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kUsage);
  EXPECT_NE(made.error().message.find("--list"), std::string::npos);
}

}  // namespace
}  // namespace trocar::view
