// SPDX-License-Identifier: Apache-2.0
// DICOM series of our own making, compressed by GDCM.
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using gdcm::TransferSyntax;
using test::DicomFields;
using testing::HasSubstr;
using testing::Not;

constexpr int kSlices = 5, kWidth = 32, kHeight = 24;

std::int16_t Value(int x, int y, int slice) {
  return static_cast<std::int16_t>(20 * slice + 5 * y + 3 * x - 60);
}

class DicomFolder : public testing::Test {
 protected:
  static DicomFields MakeFields(int slice) {
    DicomFields fields;
    fields.instance = slice;
    fields.rows = kHeight, fields.columns = kWidth;
    fields.position = "-10\\-20\\" + std::to_string(30 + 3 * slice);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) fields.pixels += test::Bytes(Value(x, y, slice));
    }
    return fields;
  }
  /// \param change  of slice 3 only
  void WriteSeries(const std::function<void(DicomFields&)>& change = {},
                   const std::string& prefix = "IM") const {
    for (int slice = 1; slice <= kSlices; ++slice) {
      DicomFields fields = MakeFields(slice);
      if (slice == 3 && change) change(fields);
      // names that sort in another order than the slices
      const std::string name = prefix + std::to_string((slice * 3) % 7);
      ASSERT_TRUE(host::WriteFile(folder_ / name, test::MakeDicom(fields)).ok());
    }
  }
  void Compress(TransferSyntax::TSType syntax) const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::istringstream stream(*host::ReadFile(entry.path()));
      gdcm::ImageReader reader;
      reader.SetStream(stream);
      ASSERT_TRUE(reader.Read());
      gdcm::ImageChangeTransferSyntax change;
      change.SetTransferSyntax(TransferSyntax(syntax));
      change.SetInput(reader.GetImage());
      ASSERT_TRUE(change.Change());
      gdcm::ImageWriter writer;
      writer.SetFile(reader.GetFile());
      writer.SetImage(change.GetOutput());
      writer.SetFileName(entry.path().c_str());
      ASSERT_TRUE(writer.Write());
      gdcm::Reader check;
      check.SetFileName(entry.path().c_str());
      ASSERT_TRUE(check.Read());
      ASSERT_EQ(check.GetFile().GetHeader().GetDataSetTransferSyntax(), TransferSyntax(syntax));
    }
  }
  void ExpectTheSeries() const {
    const auto series = ImageSeries::Open(folder_);
    ASSERT_TRUE(series.ok()) << series.error().Text();
    const ImageSeriesInfo& info = series->Info();
    EXPECT_EQ(info.format, "DICOM");
    EXPECT_EQ(info.file_frame, "LPS");
    EXPECT_EQ(info.slice_numbers, (std::vector{1, 2, 3, 4, 5}));
    EXPECT_EQ(info.width, kWidth);
    EXPECT_EQ(info.height, kHeight);
    EXPECT_DOUBLE_EQ(info.pixel_mm, 0.5);
    EXPECT_DOUBLE_EQ(info.slice_mm, 3.0);
    EXPECT_EQ(info.axes, (std::array<std::string, 3>{"left", "posterior", "superior"}));
    EXPECT_EQ(info.origin_mm, (std::array{-10.0, -20.0, 33.0}));
    EXPECT_EQ(info.grey_range,
              (std::array{Value(0, 0, 1) - 1024.0, Value(kWidth - 1, kHeight - 1, 5) - 1024.0}));
    // a window of 255 about the middle shows each value as itself, shifted
    for (const int slice : info.slice_numbers) {
      const auto picture = series->ReadSlice(slice, {-1024.0 + 127.5 - 40, 255});
      ASSERT_TRUE(picture.ok()) << picture.error().Text();
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x)
          ASSERT_EQ(picture->At(x, y)[1], std::clamp(Value(x, y, slice) + 40, 0, 255))
              << x << " " << y << " " << slice;
      }
    }
  }
  base::Error Failure(const ImageSeriesOptions& options = {}) const {
    const auto series = ImageSeries::Open(folder_, options);
    return series.ok() ? base::Error{} : series.error();
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path();
};

TEST_F(DicomFolder, ReadsUncompressed) {
  WriteSeries();
  ExpectTheSeries();
}

TEST_F(DicomFolder, ReadsRunLengths) {
  WriteSeries();
  Compress(TransferSyntax::RLELossless);
  ExpectTheSeries();
}

TEST_F(DicomFolder, ReadsJpeg2000) {
  WriteSeries();
  Compress(TransferSyntax::JPEG2000Lossless);
  ExpectTheSeries();
}

TEST_F(DicomFolder, ReadsLosslessJpeg) {
  WriteSeries();
  Compress(TransferSyntax::JPEGLosslessProcess14_1);
  ExpectTheSeries();
}

TEST_F(DicomFolder, ReadsJpegLs) {
  WriteSeries();
  Compress(TransferSyntax::JPEGLSLossless);
  ExpectTheSeries();
}

TEST_F(DicomFolder, ReadsOtherWaysToWriteElements) {
  WriteSeries();
  Compress(TransferSyntax::ImplicitVRLittleEndian);
  ExpectTheSeries();
}

TEST_F(DicomFolder, PassesOverWhatIsNoSlice) {
  WriteSeries();
  ASSERT_TRUE(host::WriteFile(folder_ / "README.txt", "about this scan").ok());
  ASSERT_TRUE(host::WriteFile(folder_ / "overview.jpg", "not looked at").ok());
  fs::create_directory(folder_ / "more");
  ExpectTheSeries();
  EXPECT_EQ(ImageSeries::Open(folder_)->Info().ignored_files, 2u);
}

TEST_F(DicomFolder, RefusesMixturesWithoutNamingAnybody) {
  const auto refuses = [&](ErrorCode code, const std::function<void(DicomFields&)>& change) {
    WriteSeries(change);
    const base::Error error = Failure();
    EXPECT_EQ(base::CodeText(error.code), base::CodeText(code)) << error.message;
    EXPECT_THAT(error.message, HasSubstr("slice 3 (IM2)"));
    EXPECT_THAT(error.message, Not(HasSubstr("Smith")));
    EXPECT_THAT(error.message, Not(HasSubstr("Jane")));
  };
  refuses(ErrorCode::kImageSeriesMixed, [](DicomFields& f) { f.patient = "Smith^John"; });
  refuses(ErrorCode::kImageSeriesMixed, [](DicomFields& f) { f.series = "9.9.9"; });
  refuses(ErrorCode::kImageSeriesMixed, [](DicomFields& f) { f.frame = "9.9.9"; });
  refuses(ErrorCode::kImageSeriesMixed, [](DicomFields& f) { f.spacing = "0.6\\0.6"; });
  refuses(ErrorCode::kImageSeriesMixed, [](DicomFields& f) { f.orientation = "1\\0\\0\\0\\0\\-1"; });
  refuses(ErrorCode::kImageSeriesUneven, [](DicomFields& f) { f.position = "-10\\-20\\40"; });
  refuses(ErrorCode::kImageSeriesUneven, [](DicomFields& f) { f.position = "-10\\-20\\36"; });
  refuses(ErrorCode::kImageGeometryInvalid, [](DicomFields& f) { f.orientation = ""; });
}

TEST_F(DicomFolder, RefusesAGapAndNamesIt) {
  WriteSeries();
  fs::remove(folder_ / "IM2");  // slice 3
  const base::Error error = Failure();
  EXPECT_EQ(error.code, ErrorCode::kImageSeriesGap);
  EXPECT_THAT(error.message, HasSubstr("1 between slice 2 (IM6) and slice 4 (IM5)"));
}

TEST_F(DicomFolder, ChoosesOneOfTwoSeries) {
  WriteSeries();
  for (int slice = 1; slice <= 3; ++slice) {
    DicomFields fields = MakeFields(slice);
    fields.series = "5.5.5";
    ASSERT_TRUE(host::WriteFile(folder_ / ("Z" + std::to_string(slice)), test::MakeDicom(fields)).ok());
  }
  EXPECT_EQ(Failure().code, ErrorCode::kImageSeriesMixed);
  ImageSeriesOptions options;
  options.series = 2;
  const auto series = ImageSeries::Open(folder_, options);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().slice_numbers.size(), 3u);
  EXPECT_EQ(series->Info().ignored_files, 5u);
  options.series = 3;
  EXPECT_EQ(Failure(options).code, ErrorCode::kImageSliceMissing);
}

TEST_F(DicomFolder, ShowsMonochrome1TheOtherWayRound) {
  for (int slice = 1; slice <= kSlices; ++slice) {
    DicomFields fields = MakeFields(slice);
    fields.shown = "MONOCHROME1";
    fields.window = "-1000,400";
    ASSERT_TRUE(host::WriteFile(folder_ / std::to_string(slice), test::MakeDicom(fields)).ok());
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().suggested_window.centre, -1000);
  EXPECT_EQ(series->Info().suggested_window.width, 400);
  const auto picture = series->ReadSlice(1, series->Info().suggested_window);
  const double share = (Value(5, 6, 1) - 1024.0 - -1200.0) / 400.0;
  EXPECT_EQ(picture->At(5, 6)[0], std::lround(255 * (1 - share)));
}

TEST_F(DicomFolder, ReadsColour) {
  for (int slice = 1; slice <= 2; ++slice) {
    DicomFields fields = MakeFields(slice);
    fields.shown = "RGB";
    fields.allocated = fields.stored = 8, fields.high = 7, fields.is_signed = 0;
    fields.intercept = "0";
    fields.pixels.clear();
    for (int i = 0; i < kWidth * kHeight * 3; ++i) fields.pixels += static_cast<char>(i + slice);
    ASSERT_TRUE(host::WriteFile(folder_ / std::to_string(slice), test::MakeDicom(fields)).ok());
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_TRUE(series->Info().is_color);
  const auto picture = series->ReadSlice(2, {});
  for (int i = 0; i < kWidth * kHeight * 3; ++i)
    ASSERT_EQ(picture->samples[i], static_cast<std::uint8_t>(i + 2));
}

TEST_F(DicomFolder, TurnsLumaAndChromaIntoColours) {
  for (int slice = 1; slice <= 2; ++slice) {
    DicomFields fields = MakeFields(slice);
    fields.shown = "YBR_FULL";
    fields.allocated = fields.stored = 8, fields.high = 7, fields.is_signed = 0;
    fields.intercept = "0";
    fields.pixels.clear();
    // red, green, blue, white and black by PS3.3 C.7.6.3.1.2, then grey
    const unsigned char known[6][3] = {{76, 85, 255},   {150, 44, 21}, {29, 255, 107},
                                       {255, 128, 128}, {0, 128, 128}, {100, 128, 128}};
    for (int i = 0; i < kWidth * kHeight; ++i) {
      for (const unsigned char value : known[std::min(i, 5)]) fields.pixels += static_cast<char>(value);
    }
    ASSERT_TRUE(host::WriteFile(folder_ / std::to_string(slice), test::MakeDicom(fields)).ok());
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_TRUE(series->Info().is_color);
  const auto picture = series->ReadSlice(1, {});
  const int expected[6][3] = {{255, 0, 0},     {0, 255, 0}, {0, 0, 255},
                              {255, 255, 255}, {0, 0, 0},   {100, 100, 100}};
  for (int i = 0; i < 6; ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture->samples[3 * i + c], expected[i][c], 2) << i << " " << c;
  }
}

TEST_F(DicomFolder, LooksColoursUpInAPalette) {
  for (const int bits : {8, 16}) {
    const auto folder = folder_ / std::to_string(bits);
    for (int slice = 1; slice <= 2; ++slice) {
      DicomFields fields = MakeFields(slice);
      fields.shown = "PALETTE COLOR";
      fields.allocated = fields.stored = 8, fields.high = 7, fields.is_signed = 0;
      fields.intercept = "0";
      // four colours, the first for the stored value 10
      for (std::uint16_t c = 0; c < 3; ++c) {
        const auto about = static_cast<std::uint16_t>(0x1101 + c);
        fields.palette += test::Element(0x28, about, "US",
                                        test::Bytes<std::uint16_t>(4) + test::Bytes<std::uint16_t>(10) +
                                            test::Bytes(static_cast<std::uint16_t>(bits)));
      }
      for (std::uint16_t c = 0; c < 3; ++c) {
        std::string entries;
        for (int i = 0; i < 4; ++i) {
          const int value = 50 * i + 10 * c + 1;
          entries += bits == 8 ? std::string(1, static_cast<char>(value))
                               : test::Bytes(static_cast<std::uint16_t>(value << 8 | 0x7F));
        }
        fields.palette += test::Element(0x28, static_cast<std::uint16_t>(0x1201 + c), "OW", entries);
      }
      fields.pixels.clear();
      for (int i = 0; i < kWidth * kHeight; ++i) fields.pixels += static_cast<char>(8 + i % 8);
      ASSERT_TRUE(host::WriteFile(folder / std::to_string(slice), test::MakeDicom(fields)).ok());
    }
    const auto series = ImageSeries::Open(folder);
    ASSERT_TRUE(series.ok()) << series.error().Text();
    EXPECT_TRUE(series->Info().is_color);
    const auto picture = series->ReadSlice(2, {});
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int entry = std::clamp(8 + i % 8 - 10, 0, 3);  // values beyond the table take its ends
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(picture->samples[3 * i + c], 50 * entry + 10 * c + 1) << bits << i;
    }
  }
}

TEST_F(DicomFolder, MakesPixelsSquare) {
  for (int slice = 1; slice <= 3; ++slice) {
    DicomFields fields = MakeFields(slice);
    fields.spacing = "1.0\\0.5";  // rows are twice as far apart as columns
    ASSERT_TRUE(host::WriteFile(folder_ / std::to_string(slice), test::MakeDicom(fields)).ok());
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const ImageSeriesInfo& info = series->Info();
  EXPECT_EQ(info.width, kWidth);
  EXPECT_EQ(info.height, 2 * (kHeight - 1) + 1);
  EXPECT_DOUBLE_EQ(info.pixel_mm, 0.5);
  const auto picture = series->ReadSlice(2, {-1024 + 127.5 - 40, 255});
  for (int y = 0; y < info.height; ++y) {
    const double expected = 0.5 * (Value(9, y / 2, 2) + Value(9, (y + 1) / 2, 2)) + 40;
    ASSERT_NEAR(picture->At(9, y)[0], std::clamp(expected, 0.0, 255.0), 0.51) << y;
  }
}

TEST(RealCt, IsReadAsItsHeaderSays) {
  const fs::path folder = fs::path(TROCAR_SHARED_DIR) / "data/ct-dicom";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  double progress = 0;
  const auto series = ImageSeries::Open(folder, {}, [&](std::string_view, double part) { progress = part; });
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(progress, 1.0);
  const ImageSeriesInfo& info = series->Info();
  EXPECT_EQ(info.slice_numbers.size(), 20u);
  EXPECT_EQ(info.width, 512);
  EXPECT_EQ(info.height, 512);
  EXPECT_NEAR(info.pixel_mm, 0.9766, 1e-4);
  EXPECT_DOUBLE_EQ(info.slice_mm, 2.0);
  EXPECT_EQ(info.axes, (std::array<std::string, 3>{"left", "posterior", "inferior"}));
  EXPECT_EQ(info.grey_range[0], -1024);
  const auto picture = series->ReadSlice(276, {60, 400});
  ASSERT_TRUE(picture.ok()) << picture.error().Text();
  // liver, at the patient's right, is grey; air around the body is black
  EXPECT_NEAR(picture->At(160, 260)[0], 150, 40);
  EXPECT_EQ(picture->At(5, 5)[0], 0);
  EXPECT_EQ(series->ReadSlice(20, {}).error().code, ErrorCode::kImageSliceMissing);
}

}  // namespace
}  // namespace trocar::images
