// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/contours/build_organs.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::contours {
namespace {

using base::ErrorCode;

// building from contours chooses one of several DICOM series as opening does
TEST(OpenContouredSeries, ChoosesOneOfTwoSeries) {
  const test::TemporaryFolder folder;
  for (int slice = 1; slice <= 8; ++slice) {
    test::DicomFields fields;
    fields.instance = slice;
    fields.rows = 12, fields.columns = 16;
    fields.position = "-10\\-20\\" + std::to_string(30 + 3 * slice);
    fields.pixels = std::string(2 * 12 * 16, '\0');
    if (slice > 5) fields.series = "5.5.5";
    ASSERT_TRUE(
        host::WriteFile(folder.Path() / ("IM" + std::to_string(slice)), test::MakeDicom(fields)).ok());
  }
  images::ImageSeriesOptions options;
  options.series = 2;
  const auto series = images::ImageSeries::Open(folder.Path(), options);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const images::ImageSeriesInfo& info = series->Info();
  ControlPoints points;
  points.width = info.width, points.height = info.height;
  points.pixel_mm = info.pixel_mm, points.slice_mm = info.slice_mm, points.axes = info.axes;
  EXPECT_EQ(OpenContouredSeries(points, folder.Path(), {}).error().code, ErrorCode::kImageSeriesMixed);
  const auto chosen = OpenContouredSeries(points, folder.Path(), {}, {}, 2);
  ASSERT_TRUE(chosen.ok()) << chosen.error().Text();
  EXPECT_EQ(chosen->Info().slice_numbers, info.slice_numbers);
}

}  // namespace
}  // namespace trocar::contours
