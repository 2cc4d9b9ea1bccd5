// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/series_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;

class SeriesList : public testing::Test {
 protected:
  void WriteDicom(const std::string& name, const std::string& series, const std::string& description,
                  int slices, double step) const {
    for (int i = 1; i <= slices; ++i) {
      test::DicomFields fields;
      fields.series = series;
      fields.instance = i;
      fields.position = "-10\\-20\\" + std::to_string(step * i);
      std::string file = test::MakeDicom(fields);
      // group 8, element 103E comes after the kind of images
      const std::string kind = test::Element(8, 0x60, "CS", "CT");
      const std::size_t at = file.find(kind);
      ASSERT_NE(at, std::string::npos);
      if (!description.empty()) file.insert(at + kind.size(), test::Element(8, 0x103E, "LO", description));
      ASSERT_TRUE(host::WriteFile(folder_.Path() / (name + std::to_string(i)), file).ok());
    }
  }
  void WritePictures(const fs::path& folder, int count) const {
    ColorImage image{300, 200, std::vector<std::uint8_t>(300 * 200 * 3, 90)};
    for (int i = 1; i <= count; ++i)
      ASSERT_TRUE(WritePng(folder / ("p" + std::to_string(i) + ".png"), image).ok());
  }
  test::TemporaryFolder folder_;
};

TEST_F(SeriesList, TellsTheSeriesOfADicomFolderApart) {
  WriteDicom("A", "1.2.1", "Portal venous 2.5", 5, 2.5);
  WriteDicom("B", "1.2.2", "", 3, 4);
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "README", "no image").ok());
  const auto listed = ListSeries(folder_.Path());
  ASSERT_TRUE(listed.ok()) << listed.error().Text();
  ASSERT_EQ(listed->size(), 2u);
  const ListedSeries &a = (*listed)[0], &b = (*listed)[1];
  EXPECT_EQ(a.description, "CT, Portal venous 2.5");
  EXPECT_EQ(b.description, "CT");
  EXPECT_EQ(a.slices, 5u);
  EXPECT_EQ(b.slices, 3u);
  EXPECT_NEAR(a.slice_mm, 2.5, 1e-9);
  EXPECT_NEAR(b.slice_mm, 4, 1e-9);
  EXPECT_NEAR(a.pixel_mm, 0.5, 1e-9);
  EXPECT_EQ(a.preview.width, 8) << "a slice to recognise it by";
  EXPECT_FALSE(a.problem || b.problem);
  // what the list says opens it
  for (const ListedSeries& one : *listed) {
    const auto opened = ImageSeries::Open(one.path, one.options);
    ASSERT_TRUE(opened.ok()) << opened.error().Text();
    EXPECT_EQ(opened->Info().slice_numbers.size(), one.slices);
  }
  EXPECT_EQ(ListSeries(folder_.Path() / "A2")->size(), 2u) << "one file stands for its folder";
}

TEST_F(SeriesList, ASeriesWithAGapIsListedWithItsReason) {
  WriteDicom("A", "1.2.1", "", 6, 2);
  fs::remove(folder_.Path() / "A3");
  const auto listed = ListSeries(folder_.Path());
  ASSERT_TRUE(listed.ok()) << listed.error().Text();
  ASSERT_EQ(listed->size(), 1u);
  ASSERT_TRUE((*listed)[0].problem.has_value());
  EXPECT_EQ((*listed)[0].problem->code, ErrorCode::kImageSeriesGap);
}

TEST_F(SeriesList, VolumesAndPicturesInFoldersAreFound) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "one" / "ct.nii", test::MakeNifti()).ok());
  fs::create_directories(folder_.Path() / "two" / "deeper");
  WritePictures(folder_.Path() / "two" / "deeper", 4);
  const auto listed = ListSeries(folder_.Path());
  ASSERT_TRUE(listed.ok()) << listed.error().Text();
  ASSERT_EQ(listed->size(), 2u);
  EXPECT_EQ((*listed)[0].format, "NIfTI");
  EXPECT_EQ((*listed)[0].description, "ct.nii");
  EXPECT_GT((*listed)[0].pixel_mm, 0);
  EXPECT_EQ((*listed)[1].format, "PNG");
  EXPECT_EQ((*listed)[1].slices, 4u);
  EXPECT_EQ((*listed)[1].pixel_mm, 0) << "pictures do not say it, and nothing is assumed";
  EXPECT_EQ((*listed)[1].preview.width, kPreviewSide);
  EXPECT_EQ((*listed)[1].preview.height, 80);
}

TEST_F(SeriesList, AFolderWithoutImagesSaysWhatToChoose) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "letter.txt", "no image").ok());
  const auto listed = ListSeries(folder_.Path());
  ASSERT_FALSE(listed.ok());
  EXPECT_EQ(listed.error().code, ErrorCode::kImageSliceMissing);
  EXPECT_THAT(listed.error().message, HasSubstr("choose the folder"));
  EXPECT_EQ(ListSeries(folder_.Path() / "gone").error().code, ErrorCode::kImageFolderMissing);
}

TEST_F(SeriesList, IsGivenUpWhenItIsStopped) {
  WritePictures(folder_.Path(), 3);
  std::stop_source stop;
  stop.request_stop();
  const auto listed = ListSeries(folder_.Path(), {}, stop.get_token());
  ASSERT_FALSE(listed.ok());
  EXPECT_EQ(listed.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace trocar::images
