// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/image_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar/images/contact_sheet.h"
#include "trocar/images/png_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;
using Axes = std::array<std::string, 3>;

ColorImage MakePicture(int number) {
  ColorImage image{30, 20, std::vector<std::uint8_t>(30 * 20 * 3)};
  for (std::size_t i = 0; i < image.samples.size(); ++i)
    image.samples[i] = static_cast<std::uint8_t>(i * 7 + static_cast<std::size_t>(number) * 31);
  return image;
}

class SeriesFolder : public testing::Test {
 protected:
  void SetUp() override {
    known_.pixel_mm = 0.5;
    known_.slice_mm = 2.0;
    known_.axes = Axes{"left", "anterior", "inferior"};
  }
  void WriteStack(int first, int last) const {
    for (int i = first; i <= last; ++i)
      ASSERT_TRUE(WritePng(folder_ / ("s" + std::to_string(i) + ".png"), MakePicture(i)).ok());
  }
  fs::path Write(const std::string& name, const std::string& content) const {
    EXPECT_TRUE(host::WriteFile(folder_ / name, content).ok());
    return folder_ / name;
  }
  base::Error Failure(const fs::path& path, const ImageSeriesOptions& options) const {
    const auto series = ImageSeries::Open(path, options);
    return series.ok() ? base::Error{} : series.error();
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path();
  ImageSeriesOptions known_;
};

TEST_F(SeriesFolder, ReadsColourPicturesAsTheyAre) {
  WriteStack(8, 12);
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const ImageSeriesInfo& info = series->Info();
  EXPECT_EQ(info.format, "PNG");
  EXPECT_EQ(info.slice_numbers, (std::vector{8, 9, 10, 11, 12}));
  EXPECT_EQ(info.pattern, "s{slice}.png");
  EXPECT_TRUE(info.is_color);
  EXPECT_EQ(info.width, 30);
  EXPECT_EQ(info.height, 20);
  EXPECT_EQ(info.axes, *known_.axes);
  EXPECT_EQ(info.file_frame, "");
  // columns to the left, rows to the front (not LPS' back), numbers to the feet
  EXPECT_EQ(info.direction[1], (std::array{0.0, -1.0, 0.0}));
  EXPECT_EQ(info.direction[2], (std::array{0.0, 0.0, -1.0}));
  for (const int i : info.slice_numbers)
    EXPECT_EQ(series->ReadSlice(i, {})->samples, MakePicture(i).samples) << i;
  EXPECT_EQ(series->ReadSlice(7, {}).error().code, ErrorCode::kImageSliceMissing);
}

TEST_F(SeriesFolder, AsksForWhatPicturesDoNotSay) {
  WriteStack(1, 3);
  ImageSeriesOptions options;
  base::Error error = Failure(folder_, options);
  EXPECT_EQ(error.code, ErrorCode::kImageSpacingUnknown);
  for (const char* option : {"--pixel-mm", "--slice-mm", "--axes"})
    EXPECT_THAT(error.message, HasSubstr(option));
  options = known_;
  options.slice_mm.reset();
  error = Failure(folder_, options);
  EXPECT_THAT(error.message, HasSubstr("--slice-mm"));
  EXPECT_THAT(error.message, testing::Not(HasSubstr("--pixel-mm")));
  options = known_;
  options.axes = Axes{"left", "right", "superior"};
  EXPECT_EQ(Failure(folder_, options).code, ErrorCode::kUsage);
  options = known_;
  options.pixel_mm = 70;
  EXPECT_EQ(Failure(folder_, options).code, ErrorCode::kImageGeometryInvalid);
}

TEST_F(SeriesFolder, NamesGapsAndTakesOnlyTheSlicesAskedFor) {
  WriteStack(1, 9);
  fs::remove(folder_ / "s4.png");
  const base::Error gap = Failure(folder_, known_);
  EXPECT_EQ(gap.code, ErrorCode::kImageSeriesGap);
  EXPECT_THAT(gap.message, HasSubstr("missing: 4;"));
  known_.slices = {2, 3, 7};
  Write("s5.png", "damaged, but not asked for");
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().slice_numbers, known_.slices);
  known_.slices = {3, 4};
  EXPECT_EQ(Failure(folder_, known_).code, ErrorCode::kImageSliceMissing);
  EXPECT_THAT(Failure(folder_, known_).message, HasSubstr("s4.png"));
}

TEST_F(SeriesFolder, RefusesASliceOfAnotherSize) {
  WriteStack(1, 3);
  ASSERT_TRUE(WritePng(folder_ / "s2.png", ColorImage{31, 20, std::vector<std::uint8_t>(31 * 20 * 3)}).ok());
  EXPECT_EQ(Failure(folder_, known_).code, ErrorCode::kImageSizeDiffers);
  EXPECT_THAT(Failure(folder_, known_).message, HasSubstr("slice 2 (s2.png)"));
}

TEST_F(SeriesFolder, RefusesEveryTruncationOfASlice) {
  WriteStack(1, 3);
  const std::string whole = *host::ReadFile(folder_ / "s2.png");
  for (std::size_t length = 0; length + 12 < whole.size(); length += 61) {
    Write("s2.png", whole.substr(0, length));
    const base::Error error = Failure(folder_, known_);
    EXPECT_TRUE(error.code == ErrorCode::kImageTruncated || error.code == ErrorCode::kImageUndecodable)
        << length << ": " << error.Text();
  }
}

TEST_F(SeriesFolder, ReadsThroughAWindowAtSixteenBits) {
  for (int i = 1; i <= 3; ++i)
    Write("g" + std::to_string(i) + ".png",
          test::MakePng(20, 10, 10, 16, [i](int x, int y) { return 1000 * i + 10 * y + x; }));
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().bits, 16);
  EXPECT_FALSE(series->Info().is_color);
  EXPECT_EQ(series->Info().grey_range, (std::array{2000.0, 2109.0}));
  const auto picture = series->ReadSlice(3, {3050, 100});
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      const double share = (3000.0 + 10 * y + x - 3000.0) / 100.0;
      ASSERT_EQ(picture->At(x, y)[2], std::lround(255 * std::clamp(share, 0.0, 1.0)));
    }
  }
}

TEST_F(SeriesFolder, ReadsTheFramesOfVolumes) {
  const auto nifti = ImageSeries::Open(Write("a.nii", test::MakeNifti()));
  ASSERT_TRUE(nifti.ok()) << nifti.error().Text();
  EXPECT_EQ(nifti->Info().format, "NIfTI");
  EXPECT_EQ(nifti->Info().file_frame, "RAS");
  EXPECT_EQ(nifti->Info().axes, (Axes{"left", "anterior", "superior"}));
  EXPECT_EQ(nifti->Info().origin_mm, (std::array{-10.0, 20.0, 30.0})) << "LPS";
  EXPECT_EQ(nifti->Info().slice_numbers, (std::vector{0, 1, 2, 3}));
  EXPECT_DOUBLE_EQ(nifti->Info().slice_mm, 2.0);

  const auto lps = ImageSeries::Open(Write("a.nrrd", test::MakeNrrd()));
  ASSERT_TRUE(lps.ok()) << lps.error().Text();
  EXPECT_EQ(lps->Info().axes, (Axes{"left", "posterior", "superior"}));
  EXPECT_EQ(lps->Info().origin_mm, (std::array{1.0, 2.0, 3.0}));
  const auto ras = ImageSeries::Open(Write("b.nrrd", test::MakeNrrd({"space: right-anterior-superior"})));
  ASSERT_TRUE(ras.ok()) << ras.error().Text();
  EXPECT_EQ(ras->Info().axes, (Axes{"right", "anterior", "superior"}));
  EXPECT_EQ(ras->Info().origin_mm, (std::array{-1.0, -2.0, 3.0}));

  // the samples are the same in all three
  for (const auto* series : {&*nifti, &*lps, &*ras}) {
    const auto picture = series->ReadSlice(2, {177.5, 255});
    ASSERT_TRUE(picture.ok());
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) ASSERT_EQ(picture->At(x, y)[0], test::Sample(x, y, 2) - 50);
    }
  }
  EXPECT_EQ(nifti->Info().grey_range, (std::array{-50.0, 307.0}));
}

TEST_F(SeriesFolder, WhatIsGivenMustAgreeWithTheHeader) {
  const fs::path path = Write("a.nii", test::MakeNifti());
  ImageSeriesOptions options;
  options.pixel_mm = 0.502;
  EXPECT_TRUE(ImageSeries::Open(path, options).ok());
  options.pixel_mm = 0.6;
  EXPECT_EQ(Failure(path, options).code, ErrorCode::kImageGeometryInvalid);
  options.pixel_mm.reset();
  options.axes = Axes{"right", "anterior", "superior"};
  EXPECT_EQ(Failure(path, options).code, ErrorCode::kImageGeometryInvalid);
}

TEST_F(SeriesFolder, ReadsBigEndianAndDetachedSamples) {
  std::string swapped = test::Samples(8, 6, 4);
  for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  Write("a.raw", swapped);
  const auto nrrd =
      ImageSeries::Open(Write("a.nhdr", test::MakeNrrd({"endian: big", "data file: a.raw"}, false)));
  ASSERT_TRUE(nrrd.ok()) << nrrd.error().Text();
  const auto meta =
      ImageSeries::Open(Write("a.mhd", test::MakeMetaImage({"BinaryDataByteOrderMSB = True"}, "a.raw")));
  ASSERT_TRUE(meta.ok()) << meta.error().Text();
  EXPECT_EQ(nrrd->Info().grey_range, (std::array{-50.0, 307.0}));
  EXPECT_EQ(meta->Info().grey_range, (std::array{-50.0, 307.0}));
  EXPECT_EQ(nrrd->ReadSlice(1, {100, 200})->samples, meta->ReadSlice(1, {100, 200})->samples);
}

TEST_F(SeriesFolder, ReadsTiffPagesAndStacks) {
  known_.pixel_mm = 1.0;
  const auto pages = ImageSeries::Open(Write("pages.tif", test::MakeTiff(6, 5, 3)), known_);
  ASSERT_TRUE(pages.ok()) << pages.error().Text();
  EXPECT_EQ(pages->Info().format, "TIFF");
  EXPECT_EQ(pages->Info().slice_numbers, (std::vector{0, 1, 2}));
  EXPECT_EQ(pages->ReadSlice(2, {})->At(4, 1)[0], 20 + 10);
  for (int i = 1; i <= 2; ++i) Write("t0" + std::to_string(i) + ".tiff", test::MakeTiff(6, 5, 1));
  known_.pattern = "t{slice:02}.tiff";
  const auto stack = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(stack.ok()) << stack.error().Text();
  EXPECT_EQ(stack->ReadSlice(2, {})->At(4, 1)[0], 10);
}

TEST_F(SeriesFolder, SaysWhenAFolderHoldsOneVolume) {
  Write("a.nii.gz", test::Gzip(test::MakeNifti()));
  EXPECT_THAT(Failure(folder_, {}).message, HasSubstr("a.nii.gz; name that file"));
}

TEST_F(SeriesFolder, RefusesMoreThanTheMemoryAllowed) {
  ImageSeriesOptions options;
  const fs::path path = Write("a.nii", test::MakeNifti());
  options.memory_bytes = 8 * 6 * 4 * 2;
  EXPECT_TRUE(ImageSeries::Open(path, options).ok());
  --options.memory_bytes;
  EXPECT_EQ(Failure(path, options).code, ErrorCode::kImageTooLarge);
}

TEST_F(SeriesFolder, ServesManyThreads) {
  WriteStack(1, 8);
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  std::atomic<int> good = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 12; ++i) {
        const int number = 1 + (i * 5 + t) % 8;
        const auto picture = series->ReadSlice(number, {});
        good += picture.ok() && picture->samples == MakePicture(number).samples;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 72);
}

TEST_F(SeriesFolder, ASliceThatBreaksLaterIsNamed) {
  WriteStack(1, 4);
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok());
  Write("s3.png", "now it is something else");
  const auto broken = series->ReadSlice(3, {});
  ASSERT_FALSE(broken.ok());
  EXPECT_THAT(broken.error().message, HasSubstr("slice 3: "));
  EXPECT_TRUE(series->ReadSlice(4, {}).ok());
  const auto several = ReadSlices(*series, std::vector{1, 2, 3, 4}, {});
  ASSERT_FALSE(several.ok());
  EXPECT_THAT(several.error().message, HasSubstr("slice 3: "));
}

TEST_F(SeriesFolder, OddNamesAreSafe) {
  const fs::path odd = folder_ / "new\nline \u202Egnp.exe";
  fs::create_directories(odd);
  for (int i = 1; i <= 2; ++i)
    ASSERT_TRUE(WritePng(odd / (std::string(240, 'n') + std::to_string(i) + ".png"), MakePicture(i)).ok());
  EXPECT_TRUE(ImageSeries::Open(odd, known_).ok());
  ASSERT_TRUE(host::WriteFile(odd / (std::string(240, 'n') + "2.png"), "no").ok());
  const std::string message = Failure(odd, known_).message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_EQ(message.find("\u202E"), std::string::npos) << message;
}

TEST_F(SeriesFolder, ContactSheetShowsEvenlyChosenSlices) {
  for (int i = 1; i <= 9; ++i) {
    Write("g" + std::to_string(i) + ".png", test::MakePng(100, 50, 50, 8, [i](int, int) { return 20 * i; }));
  }
  const auto series = ImageSeries::Open(folder_, known_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const auto sheet = DrawContactSheet(*series, {}, {2, 2, 100});
  ASSERT_TRUE(sheet.ok()) << sheet.error().Text();
  EXPECT_EQ(sheet->width, 2 * 104 + 4);
  EXPECT_EQ(sheet->height, 2 * 54 + 4);
  // slices 1, 3, 6 and 9, in the lower right of their tiles
  const int shades[] = {20, 60, 120, 180};
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(sheet->At(4 + i % 2 * 104 + 90, 4 + i / 2 * 54 + 40)[0], shades[i]) << i;
}

}  // namespace
}  // namespace trocar::images
