// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/image_stack.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

TEST(ReadImage, RefusesNoise) {
  const test::TemporaryFolder temporary;
  const fs::path& folder = temporary.Path();
  ASSERT_TRUE(host::WriteFile(folder / "a.png", "this is no picture at all").ok());
  EXPECT_EQ(ReadImage(folder / "a.png").error().code, ErrorCode::kImageUndecodable);
  EXPECT_EQ(ReadImage(folder).error().code, ErrorCode::kImagePathUnsafe);
  EXPECT_EQ(ReadImage(folder / "none.png").error().code, ErrorCode::kFileMissing);
  EXPECT_EQ(ReadLabelVolume(folder / "a.png").error().code, ErrorCode::kImageUndecodable);
  EXPECT_EQ(ReadLabelVolume(folder / "none.nii").error().code, ErrorCode::kFileMissing);
  ASSERT_TRUE(WritePng(folder / "b.png", ColorImage{2, 1, {1, 2, 3, 4, 5, 6}}).ok());
  EXPECT_EQ(ReadLabelVolume(folder / "b.png").error().code, ErrorCode::kImageUndecodable);
  const auto whole = ReadImage(folder / "b.png");
  ASSERT_TRUE(whole.ok()) << whole.error().Text();
  EXPECT_EQ(whole->samples, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));
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
  const auto whole = host::ReadFile(photograph);
  const test::TemporaryFolder folder;
  const fs::path cut = folder.Path() / "cut.jpeg";
  for (const double part : {0.0, 0.001, 0.01, 0.3, 0.9, 0.999}) {
    ASSERT_TRUE(host::WriteFile(cut, whole->substr(0, static_cast<std::size_t>(
                                                          part * static_cast<double>(whole->size()))))
                    .ok());
    const auto broken = ReadImage(cut);
    ASSERT_FALSE(broken.ok()) << part;
    EXPECT_TRUE(broken.error().code == ErrorCode::kImageTruncated ||
                broken.error().code == ErrorCode::kImageUndecodable)
        << broken.error().Text();
    EXPECT_TRUE(part < 0.1 || broken.error().code == ErrorCode::kImageTruncated);
  }
}

}  // namespace
}  // namespace trocar::images
