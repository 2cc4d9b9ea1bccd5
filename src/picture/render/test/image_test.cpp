// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/image.h"

#include <gtest/gtest.h>

#include <fstream>

#include "trocar/host/safe_file.h"
#include "trocar/math/random.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::render {
namespace {

Image MakeNoise(int width, int height, std::uint64_t seed) {
  Image image{width, height, {}};
  math::Random random(seed);
  for (int i = 0; i < 3 * width * height; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(random.NextWord()));
  return image;
}

TEST(Png, RoundTripsThroughAFile) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "new" / "noise.png";
  const Image image = MakeNoise(37, 21, 5);
  ASSERT_TRUE(WritePng(path, image).ok());
  const auto bytes = host::ReadFile(path);
  ASSERT_TRUE(bytes.ok());
  const auto again = ParsePng(*bytes, "noise.png");
  ASSERT_TRUE(again.ok()) << again.error().Text();
  EXPECT_EQ(*again, image);
}

TEST(Png, RejectsEveryTruncation) {
  const auto bytes = FormatPng(MakeNoise(9, 7, 1));
  ASSERT_TRUE(bytes.ok());
  for (std::size_t size = 0; size + 13 < bytes->size(); ++size) {  // the end mark itself carries no pixel
    const auto image = ParsePng(std::string_view(*bytes).substr(0, size), "short.png");
    ASSERT_FALSE(image.ok()) << size;
    EXPECT_EQ(image.error().code, base::ErrorCode::kImageUndecodable);
    EXPECT_NE(image.error().message.find("short.png"), std::string::npos);
  }
}

TEST(Png, SurvivesAnyFlippedByte) {
  const auto bytes = FormatPng(MakeNoise(9, 7, 2));
  ASSERT_TRUE(bytes.ok());
  for (std::size_t i = 0; i < bytes->size(); ++i) {
    std::string broken = *bytes;
    broken[i] = static_cast<char>(broken[i] ^ 0x55);
    const auto image = ParsePng(broken, "broken.png");
    if (!image.ok()) continue;
    EXPECT_EQ(image->pixels.size(), 3u * static_cast<std::size_t>(image->width * image->height));
  }
}

TEST(Png, RefusesAPictureWithoutPixelsAndAFolderThatIsAFile) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(WritePng(folder.Path() / "none.png", {}).error().code, base::ErrorCode::kFileUnwritable);
  const auto file = folder.Path() / "plain";
  std::ofstream(file) << "x";
  EXPECT_EQ(WritePng(file / "a.png", MakeNoise(4, 4, 3)).error().code, base::ErrorCode::kFileUnwritable);
}

TEST(CalcMeanDifference, IsTheMeanOfAbsoluteDifferences) {
  const Image a{2, 1, {0, 10, 20, 30, 40, 50}}, b{2, 1, {6, 10, 20, 24, 40, 50}};
  EXPECT_DOUBLE_EQ(CalcMeanDifference(a, b), 2.0);
  EXPECT_DOUBLE_EQ(CalcMeanDifference(a, a), 0.0);
}

TEST(Image, AtCountsRowsFromTheTop) {
  const Image image{1, 2, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(image.At(0, 1), (std::array<std::uint8_t, 3>{4, 5, 6}));
}

}  // namespace
}  // namespace trocar::render
