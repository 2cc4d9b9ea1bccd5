// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/image_stack.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/anatomy/overlay.h"
#include "trocar/core/safe_file.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;

class ImageStack : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("image_stack_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    for (int slice = 1; slice <= 12; ++slice) {
      ASSERT_TRUE(
          WritePng(folder_ / ("s" + std::to_string(slice) + ".png"), MakePicture(30, 20, slice)).ok());
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  static ColorImage MakePicture(int width, int height, int number) {
    ColorImage image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
    for (std::size_t i = 0; i < image.samples.size(); ++i)
      image.samples[i] = static_cast<std::uint8_t>(i * 7 + number * 31);
    return image;
  }
  core::Result<std::map<int, ColorImage>> Load(std::vector<int> slices) {
    return LoadSlices({folder_, "s{slice}.png", 30, 20}, slices);
  }

  fs::path folder_;
};

TEST_F(ImageStack, ReadsEverySliceAndReportsProgress) {
  std::vector<int> slices;
  for (int i = 1; i <= 12; ++i) slices.push_back(i);
  int calls = 0;
  const auto images =
      LoadSlices({folder_, "s{slice}.png", 30, 20}, slices, [&](std::string_view, double part) {
        EXPECT_LE(part, 1.0);
        ++calls;
      });
  ASSERT_TRUE(images.ok()) << images.error().Text();
  EXPECT_GE(calls, 2);
  for (int i = 1; i <= 12; ++i) EXPECT_EQ(images->at(i).samples, MakePicture(30, 20, i).samples) << i;
}

TEST_F(ImageStack, NamesAMissingFolder) {
  fs::remove_all(folder_);
  EXPECT_EQ(Load({1}).error().code, ErrorCode::kImageFolderMissing);
}

TEST_F(ImageStack, NamesAMissingSlice) {
  fs::remove(folder_ / "s7.png");
  const auto images = Load({5, 6, 7, 8});
  ASSERT_FALSE(images.ok());
  EXPECT_EQ(images.error().code, ErrorCode::kImageSliceMissing);
  EXPECT_NE(images.error().message.find("slice 7"), std::string::npos);
}

TEST_F(ImageStack, RefusesASliceOfAnotherSize) {
  ASSERT_TRUE(WritePng(folder_ / "s3.png", MakePicture(31, 20, 3)).ok());
  const auto images = Load({2, 3});
  ASSERT_FALSE(images.ok());
  EXPECT_EQ(images.error().code, ErrorCode::kImageSizeDiffers);
  EXPECT_NE(images.error().message.find("slice 3"), std::string::npos);
}

TEST_F(ImageStack, RefusesEveryTruncation) {
  const auto whole = core::ReadFile(folder_ / "s2.png");
  ASSERT_TRUE(whole.ok());
  for (std::size_t length = 0; length + 12 < whole->size(); length += 13) {
    ASSERT_TRUE(core::WriteFile(folder_ / "s2.png", whole->substr(0, length)).ok());
    const auto image = ReadImage(folder_ / "s2.png");
    ASSERT_FALSE(image.ok()) << length;
    EXPECT_EQ(image.error().code, ErrorCode::kImageUndecodable);
  }
}

TEST_F(ImageStack, RefusesNoise) {
  ASSERT_TRUE(core::WriteFile(folder_ / "s4.png", "this is no picture at all").ok());
  EXPECT_EQ(Load({4}).error().code, ErrorCode::kImageUndecodable);
  EXPECT_EQ(ReadImage(folder_).error().code, ErrorCode::kImageUndecodable);
  EXPECT_EQ(ReadImage(folder_ / "none.png").error().code, ErrorCode::kFileMissing);
  EXPECT_EQ(ReadLabelVolume(folder_ / "s5.png").error().code, ErrorCode::kImageUndecodable);
  EXPECT_EQ(ReadLabelVolume(folder_ / "none.nii").error().code, ErrorCode::kFileMissing);
}

TEST(ReadImage, RefusesATruncatedPhotograph) {
  const fs::path photograph = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/slices/image-0546.jpeg";
  if (!fs::exists(photograph)) GTEST_SKIP() << photograph.parent_path() << " is not there";
  const auto image = ReadImage(photograph);
  ASSERT_TRUE(image.ok()) << image.error().Text();
  EXPECT_EQ(image->width, 1280);
  EXPECT_EQ(image->height, 720);
  // liver is dark red
  EXPECT_GT(image->At(440, 350)[0], image->At(440, 350)[2] + 20);
  const auto whole = core::ReadFile(photograph);
  const fs::path cut = fs::path(testing::TempDir()) / "cut.jpeg";
  for (const double part : {0.0, 0.001, 0.01, 0.3, 0.9, 0.999}) {
    ASSERT_TRUE(core::WriteFile(cut, whole->substr(0, static_cast<std::size_t>(
                                                          part * static_cast<double>(whole->size()))))
                    .ok());
    const auto broken = ReadImage(cut);
    ASSERT_FALSE(broken.ok()) << part;
    EXPECT_EQ(broken.error().code, ErrorCode::kImageUndecodable);
  }
  fs::remove(cut);
}

TEST(DrawOverlay, ShowsTheStagesInTheirColours) {
  ColorImage photograph{100, 100, std::vector<std::uint8_t>(30000, 100)};
  Overlay overlay;
  overlay.contours = {{{{40, 40}, {60, 40}, {60, 60}, {40, 60}},
                       {{42, 42}, {58, 42}, {58, 58}, {42, 58}},
                       {{45, 45}, {55, 45}, {55, 55}, {45, 55}}}};
  overlay.areas = {FillArea({{{45, 45}, {55, 45}, {55, 55}, {45, 55}}}, {})};
  overlay.tube_points = {{50, 50}};
  const ColorImage picture = DrawOverlay(photograph, overlay, 2);
  // the crop starts 30 pixels before the first point
  const auto at = [&](int x, int y) { return picture.At((x - 10) * 2, (y - 10) * 2); };
  EXPECT_GT(at(40, 40)[0], 200);
  EXPECT_LT(at(40, 40)[1], 100);
  EXPECT_GT(at(58, 58)[1], 200);
  EXPECT_GT(at(58, 58)[0], 200);
  EXPECT_GT(picture.At(81, 81)[2], 200);  // the cross in the middle of pixel (50, 50)
  EXPECT_GT(at(48, 53)[0], 110);
  EXPECT_EQ(at(30, 30)[0], 100);
}

}  // namespace
}  // namespace trocar::anatomy
