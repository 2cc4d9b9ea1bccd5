// SPDX-License-Identifier: Apache-2.0
// What a scanner writes where it has no image (Pixel Padding Value, PS3.3 section C.7.5.1.1.2) is air, and never tissue or bone.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

using test::Bytes;
using test::DicomFields;
using test::Element;

constexpr int kColumns = 8, kRows = 6;

class DicomPadding : public testing::Test {
 protected:
  /// One slice of `values`, each row as a line; HU are its stored values.
  DicomPadding() {
    fields_.intercept = "0";
    values_.assign(kColumns * kRows, 40);
    values_[At(3, 2)] = -1000, values_[At(4, 2)] = 1200;
  }
  static std::size_t At(int x, int y) { return static_cast<std::size_t>(y) * kColumns + x; }
  static std::string Value(std::uint16_t element, std::int16_t value) {
    return Element(0x28, element, "SS", Bytes(value));
  }
  ImageSeriesInfo Read() {
    fields_.pixels.clear();
    for (const int value : values_) fields_.pixels += Bytes(static_cast<std::uint16_t>(value));
    EXPECT_TRUE(host::WriteFile(folder_.Path() / "slice", MakeDicom(fields_)).ok());
    ImageSeriesOptions alone;
    alone.slice_mm = 1;
    const auto series = ImageSeries::Open(folder_.Path() / "slice", alone);
    EXPECT_TRUE(series.ok()) << series.error().Text();
    if (!series.ok()) return {};
    const auto picture = series->ReadSlice(series->Info().slice_numbers[0], {0, 2550});
    EXPECT_TRUE(picture.ok());
    if (picture.ok()) picture_ = *picture;
    return series->Info();
  }
  /// Steps of 10 HU from -1275 on.
  int Shown(int x, int y) const { return picture_.At(x, y)[0]; }

  DicomFields fields_;
  std::vector<int> values_;
  ColorImage picture_;
  test::TemporaryFolder folder_;
};

TEST_F(DicomPadding, BeyondAllOtherValuesIsAirWhereverItStands) {
  for (const std::int16_t padding : {std::int16_t{-2000}, std::int16_t{32767}}) {
    values_[At(0, 0)] = values_[At(7, 5)] = padding;
    values_[At(5, 3)] = padding;  // in the middle of tissue
    fields_.padding = Value(0x120, padding);
    const ImageSeriesInfo info = Read();
    EXPECT_EQ(info.grey_range, (std::array{-1024.0, 1200.0})) << padding;
    for (const auto& [x, y] : {std::pair{0, 0}, {7, 5}, {5, 3}}) EXPECT_EQ(Shown(x, y), 25) << padding;
    EXPECT_EQ(Shown(1, 1), 132) << "tissue of 40 HU stays";
  }
}

TEST_F(DicomPadding, IsARangeWhereALimitStandsBesideIt) {
  values_[At(0, 0)] = -3000, values_[At(1, 0)] = -2500, values_[At(2, 0)] = -2000;
  fields_.padding = Value(0x120, -2000) + Value(0x121, -3000);
  EXPECT_EQ(Read().grey_range[0], -1024);
}

// 0 HU is water: some writers call it padding and have it within the body, too
TEST_F(DicomPadding, OfAValueOfTissueIsAirAtTheBorderOnly) {
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {5, 3}, {6, 3}}) values_[At(x, y)] = 0;
  fields_.padding = Value(0x120, 0);
  Read();
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}}) EXPECT_EQ(Shown(x, y), 25) << x << ", " << y;
  for (const auto& [x, y] : {std::pair{5, 3}, {6, 3}}) EXPECT_EQ(Shown(x, y), 128) << x << ", " << y;
}

TEST_F(DicomPadding, OfUnsignedValuesIsAirByTheirScale) {
  fields_.intercept = "-1024", fields_.is_signed = 0;
  for (int& value : values_) value += 1024;
  values_[At(0, 0)] = 63536;
  fields_.padding = Element(0x28, 0x120, "US", Bytes<std::uint16_t>(63536));
  const ImageSeriesInfo info = Read();
  EXPECT_EQ(info.grey_range, (std::array{-1024.0, 1200.0}));
}

TEST_F(DicomPadding, OfASliceOfNothingElseIsAir) {
  values_.assign(values_.size(), -2000);
  fields_.padding = Value(0x120, -2000);
  EXPECT_EQ(Read().grey_range, (std::array{-1024.0, -1024.0}));
}

TEST_F(DicomPadding, OfOtherImagesIsTheirDarkest) {
  fields_.modality = "MR", fields_.sop_class = "1.2.840.10008.5.1.4.1.1.4";
  values_[At(0, 0)] = 32767;
  fields_.padding = Value(0x120, 32767);
  EXPECT_EQ(Read().grey_range, (std::array{-1000.0, 1200.0}));
  EXPECT_EQ(Shown(0, 0), 28);
  fields_.shown = "MONOCHROME1";
  EXPECT_EQ(Read().grey_range, (std::array{-1000.0, 1200.0}));
  EXPECT_EQ(Shown(0, 0), Shown(4, 2)) << "large values are dark";
}

}  // namespace
}  // namespace trocar::images
