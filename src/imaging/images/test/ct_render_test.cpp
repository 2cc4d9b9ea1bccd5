// SPDX-License-Identifier: Apache-2.0
// A CT of a ball in muscle: numbers, partial volume and noise against their formulas, and the series read back.
#include "trocar/images/ct_render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "trocar/images/image_series.h"
#include "trocar/images/series_list.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

constexpr double kRadius = 20;

/// 80 x 72 x 60 mm of muscle with a ball of liver in the middle, voxels of 1 mm.
TissueVolume MakeBall() {
  TissueVolume tissues;
  tissues.size = {80, 72, 60};
  tissues.origin_mm = {-30, -100, 900};
  for (int k = 0; k < 60; ++k) {
    for (int j = 0; j < 72; ++j) {
      for (int i = 0; i < 80; ++i) {
        const double away = std::hypot(i - 39.5, j - 35.5, k - 29.5);
        tissues.tissues.push_back(away < kRadius ? CtTissue::kLiver : CtTissue::kMuscle);
      }
    }
  }
  return tissues;
}

CtSettings Still() {
  CtSettings settings;
  settings.blur_mm = 0, settings.noise_hu = 0;
  return settings;
}

TEST(RenderCt, ShowsEachTissueByPhase) {
  for (const CtPhase phase : {CtPhase::kNone, CtPhase::kArterial, CtPhase::kPortalVenous}) {
    CtSettings settings = Still();
    settings.phase = phase;
    const auto ct = RenderCt(MakeBall(), settings);
    ASSERT_TRUE(ct.ok()) << ct.error().Text();
    EXPECT_EQ(ct->size, (std::array<int, 3>{100, 90, 20}));
    const auto at = [&](int i, int j, int k) { return ct->hounsfield[(k * 90 + j) * 100 + i]; };
    EXPECT_EQ(at(50, 45, 10), FindHounsfield(CtTissue::kLiver, phase));
    EXPECT_EQ(at(2, 2, 2), FindHounsfield(CtTissue::kMuscle, phase));
  }
  // the liver takes contrast up late, arteries at once, bile never
  EXPECT_GT(FindHounsfield(CtTissue::kLiver, CtPhase::kPortalVenous),
            FindHounsfield(CtTissue::kLiver, CtPhase::kNone) + 49);
  EXPECT_GT(FindHounsfield(CtTissue::kArterialBlood, CtPhase::kArterial), 250);
  EXPECT_LT(std::fabs(FindHounsfield(CtTissue::kBile, CtPhase::kPortalVenous)), 20);
}

// the mean over the ball's box is that of the volumes: partial volume loses nothing
TEST(RenderCt, KeepsVolumesInThickSlices) {
  const TissueVolume tissues = MakeBall();
  const double liver = FindHounsfield(CtTissue::kLiver, CtPhase::kPortalVenous),
               muscle = FindHounsfield(CtTissue::kMuscle, CtPhase::kPortalVenous);
  const double voxels =
      static_cast<double>(std::count(tissues.tissues.begin(), tissues.tissues.end(), CtTissue::kLiver));
  for (const double slice_mm : {1.0, 3.0, 5.0}) {
    CtSettings settings = Still();
    settings.slice_mm = slice_mm;
    const auto ct = RenderCt(tissues, settings);
    ASSERT_TRUE(ct.ok());
    double sum = 0;
    int between = 0;
    for (const std::int16_t value : ct->hounsfield) {
      sum += value - muscle;
      between += value > muscle + 2 && value < liver - 2;
    }
    const double voxel = settings.pixel_mm * settings.pixel_mm * slice_mm;
    EXPECT_NEAR(sum * voxel, voxels * (liver - muscle), 0.01 * voxels * (liver - muscle)) << slice_mm;
    // thick slices cut the ball's surface aslant
    EXPECT_GT(between * voxel, 2.0 * M_PI * kRadius * kRadius * std::min(slice_mm, 0.8) * 0.5) << slice_mm;
  }
}

TEST(RenderCt, DrawsNoiseOfItsSizeAndSpectrum) {
  CtSettings settings = Still();
  const auto still = RenderCt(MakeBall(), settings);
  settings.noise_hu = 12;
  const auto noisy = RenderCt(MakeBall(), settings), again = RenderCt(MakeBall(), settings);
  settings.seed = 2;
  const auto other = RenderCt(MakeBall(), settings);
  ASSERT_TRUE(still.ok() && noisy.ok() && again.ok() && other.ok());
  EXPECT_EQ(noisy->hounsfield, again->hounsfield);
  EXPECT_NE(noisy->hounsfield, other->hounsfield);
  const int width = 100, plane = 9000;
  double square = 0, beside = 0, far = 0, above = 0;
  const auto count = static_cast<double>(noisy->hounsfield.size());
  std::vector<double> noise(noisy->hounsfield.size());
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = noisy->hounsfield[i] - still->hounsfield[i];
  for (std::size_t i = 0; i + plane < noise.size(); ++i) {
    square += noise[i] * noise[i] / count, beside += noise[i] * noise[i + 1] / count;
    far += noise[i] * noise[i + 3] / count, above += noise[i] * noise[i + plane] / count;
  }
  const double scale = count / (count - plane);
  EXPECT_NEAR(std::sqrt(square * scale), 12.0, 0.3);
  // neighbours go together, those 2.4 mm away the other way, slices know nothing of each other
  EXPECT_GT(beside / square, 0.2);
  EXPECT_LT(far / square, -0.02);
  EXPECT_NEAR(above / square, 0, 0.02);
  // the spectrum falls towards low frequencies: pixels in blocks of 64 have less variance a pixel than in blocks of 4, where
  // white noise has the same and smoothed noise more
  const auto density = [&](int side) {
    double sum = 0;
    int blocks = 0;
    for (int k = 0; k < 20; ++k) {
      for (int j = 0; j + side <= 90; j += side) {
        for (int i = 0; i + side <= width; i += side, ++blocks) {
          double block = 0;
          for (int p = 0; p < side * side; ++p)
            block += noise[k * plane + (j + p / side) * width + i + p % side];
          sum += block * block / (side * side);
        }
      }
    }
    return sum / blocks;
  };
  EXPECT_LT(density(8), 0.8 * density(2));
}

TEST(RenderCt, RefusesSettingsOutOfRange) {
  for (const auto& change :
       {+[](CtSettings& s) { s.pixel_mm = 0.1; }, +[](CtSettings& s) { s.slice_mm = 11; },
        +[](CtSettings& s) { s.blur_mm = -1; }, +[](CtSettings& s) { s.noise_hu = 101; },
        +[](CtSettings& s) { s.noise_hu = std::nan(""); }}) {
    CtSettings settings;
    change(settings);
    const auto ct = RenderCt(MakeBall(), settings);
    ASSERT_FALSE(ct.ok());
    EXPECT_EQ(ct.error().code, base::ErrorCode::kUsage);
  }
  std::stop_source stop;
  stop.request_stop();
  const auto ct = RenderCt(MakeBall(), CtSettings(), stop.get_token());
  ASSERT_FALSE(ct.ok());
  EXPECT_EQ(ct.error().code, base::ErrorCode::kCancelled);
  for (const CtPhase phase : {CtPhase::kNone, CtPhase::kArterial, CtPhase::kPortalVenous})
    EXPECT_EQ(FindCtPhase(NameOf(phase)), phase);
  EXPECT_FALSE(FindCtPhase("late").has_value());
}

TEST(WriteDicom, IsReadBackAsItWasDrawn) {
  const test::TemporaryFolder folder;
  CtSettings settings;
  settings.slice_mm = 5;
  const auto ct = RenderCt(MakeBall(), settings);
  ASSERT_TRUE(ct.ok());
  ASSERT_TRUE(WriteDicom(folder.Path(), *ct).ok());
  const auto listed = ListSeries(folder.Path());
  ASSERT_TRUE(listed.ok()) << listed.error().Text();
  ASSERT_EQ(listed->size(), 1u);
  EXPECT_EQ(listed->front().description, "CT, Phantom, portal venous phase");
  EXPECT_FALSE(listed->front().problem.has_value());
  const auto series = ImageSeries::Open(folder.Path());
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const ImageSeriesInfo& info = series->Info();
  EXPECT_EQ(info.width, 100);
  EXPECT_EQ(info.height, 90);
  EXPECT_EQ(info.slice_numbers.size(), 12u);
  EXPECT_NEAR(info.pixel_mm, 0.8, 1e-6);
  EXPECT_NEAR(info.slice_mm, 5, 1e-6);
  EXPECT_EQ(info.axes, (std::array<std::string, 3>{"left", "posterior", "superior"}));
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(info.origin_mm[axis], ct->origin_mm[axis], 1e-4);
  const auto [low, high] = std::minmax_element(ct->hounsfield.begin(), ct->hounsfield.end());
  EXPECT_EQ(info.grey_range[0], *low);
  EXPECT_EQ(info.grey_range[1], *high);
  // a window of 255 HU shows each number as a grey of its own
  const auto picture = series->ReadSlice(info.slice_numbers[6], {77.5, 255});
  ASSERT_TRUE(picture.ok()) << picture.error().Text();
  for (int p = 0; p < 9000; p += 7) {
    const int grey = std::clamp<int>(ct->hounsfield[6 * 9000 + p] + 50, 0, 255);
    ASSERT_NEAR(picture->At(p % 100, p / 100)[0], grey, 1) << p;
  }
}

// attributes ascend, and every value that would name a person is empty
TEST(WriteDicom, NamesNobody) {
  const test::TemporaryFolder folder;
  const auto ct = RenderCt(MakeBall(), CtSettings());
  ASSERT_TRUE(ct.ok());
  ASSERT_TRUE(WriteDicom(folder.Path(), *ct).ok());
  std::ifstream stream(folder.Path() / "slice-0001.dcm", std::ios::binary);
  const std::string file((std::istreambuf_iterator<char>(stream)), {});
  ASSERT_GT(file.size(), 132u + 18000u);
  std::map<std::uint32_t, std::string> values;
  std::uint32_t before = 0;
  std::size_t at = 132;
  const auto number = [&](std::size_t from, int bytes) {
    std::uint32_t sum = 0;
    for (int i = 0; i < bytes; ++i)
      sum |= static_cast<std::uint32_t>(static_cast<unsigned char>(file[from + i])) << 8 * i;
    return sum;
  };
  while (at < file.size()) {
    const std::uint32_t tag = number(at, 2) << 16 | number(at + 2, 2);
    EXPECT_GT(tag, before);
    const bool is_long = file[at + 4] == 'O';
    const std::size_t size = is_long ? number(at + 8, 4) : number(at + 6, 2);
    EXPECT_EQ(size % 2, 0u);
    at += is_long ? 12 : 8;
    values[before = tag] = file.substr(at, size);
    at += size;
  }
  EXPECT_EQ(at, file.size());
  for (const std::uint32_t tag : {0x00080020u, 0x00080030u, 0x00080050u, 0x00080090u, 0x00100010u,
                                  0x00100020u, 0x00100030u, 0x00100040u, 0x00200010u}) {
    ASSERT_TRUE(values.contains(tag)) << std::hex << tag;
    EXPECT_EQ(values[tag], "") << std::hex << tag;
  }
  for (const std::uint32_t tag : {0x00080018u, 0x0020000Du, 0x0020000Eu, 0x00200052u}) {
    EXPECT_TRUE(values[tag].starts_with("2.25.")) << std::hex << tag;
    EXPECT_LE(values[tag].size(), 64u);
  }
}

TEST(LabelsOn, FollowsAMapThatRunsOtherwise) {
  const auto ct = RenderCt(MakeBall(), Still());
  ASSERT_TRUE(ct.ok());
  // columns to the right, slices to inferior, 2 mm
  LabelVolume map;
  map.size = {40, 36, 30};
  map.direction = {{{-2, 0, 0}, {0, 2, 0}, {0, 0, -2}}};
  map.origin = {-30 + 78, -100, 900 + 58};
  for (int k = 0; k < 30; ++k) {
    for (int j = 0; j < 36; ++j) {
      for (int i = 0; i < 40; ++i) map.labels.push_back(78 - 2 * i < 30 && 58 - 2 * k < 20 ? 3 : 0);
    }
  }
  const LabelVolume on = LabelsOn(*ct, map);
  EXPECT_EQ(on.size, ct->size);
  const auto at = [&](int i, int j, int k) { return on.labels[(k * 90 + j) * 100 + i]; };
  EXPECT_EQ(at(5, 40, 2), 3);   // 4 mm from the right edge, 7 mm from below
  EXPECT_EQ(at(60, 40, 2), 0);  // too far left
  EXPECT_EQ(at(5, 40, 15), 0);  // too high
  EXPECT_EQ(at(34, 40, 5), 3);  // 27.6 mm
  EXPECT_EQ(at(38, 40, 5), 0);  // 30.8 mm
}

}  // namespace
}  // namespace trocar::images
