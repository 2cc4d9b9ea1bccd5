// SPDX-License-Identifier: Apache-2.0
// A folder with anything else in it leads to its CT; and other ways to write the same slices.
#include "dicom_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar/images/series_list.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using test::Bytes;
using test::DicomFields;
using test::Element;
using test::MakeDicom;
using test::Sequence;
using testing::HasSubstr;
using testing::Not;

constexpr int kSlices = 6;
constexpr double kStepMm = 3;

class MixedFolder : public testing::Test {
 protected:
  /// Slice `slice` (from 1 on) of the CT; its samples tell which one it is.
  static DicomFields SliceFields(int slice) {
    DicomFields fields;
    fields.instance = slice;
    fields.position = "-10\\-20\\" + std::to_string(30 + kStepMm * slice);
    for (int i = 0; i < 8 * 6; ++i) fields.pixels += Bytes(static_cast<std::int16_t>(100 * slice + i));
    return fields;
  }
  void WriteCt(const std::function<void(DicomFields&)>& change = {}, const std::string& prefix = "IM") const {
    for (int slice = 1; slice <= kSlices; ++slice) {
      DicomFields fields = SliceFields(slice);
      if (change) change(fields);
      Write(prefix + std::to_string(slice), MakeDicom(fields));
    }
  }
  void Write(const std::string& name, const std::string& content) const {
    ASSERT_TRUE(host::WriteFile(folder_ / name, content).ok());
  }
  /// The CT is opened, whatever else is there; its middle slice is what it should be.
  ImageSeriesInfo ExpectCt(const ImageSeriesOptions& options = {}) const {
    const auto series = ImageSeries::Open(folder_, options);
    EXPECT_TRUE(series.ok()) << series.error().Text();
    if (!series.ok()) return {};
    const ImageSeriesInfo& info = series->Info();
    EXPECT_EQ(info.slice_numbers.size(), static_cast<std::size_t>(kSlices));
    EXPECT_DOUBLE_EQ(info.slice_mm, kStepMm);
    EXPECT_EQ(info.origin_mm[2], 30 + kStepMm);
    EXPECT_EQ(info.grey_range, (std::array{100.0 - 1024, 100.0 * kSlices + 47 - 1024}));
    const auto picture = series->ReadSlice(info.slice_numbers[2], {300 - 1024 + 127.5 - 100, 255});
    EXPECT_TRUE(picture.ok());
    if (picture.ok()) EXPECT_EQ(picture->At(5, 2)[0], 100 + 21);
    return info;
  }
  std::string OpenText(const ImageSeriesOptions& options = {}) const {
    const auto series = ImageSeries::Open(folder_, options);
    return series.ok() ? "opened" : series.error().Text();
  }
  static std::string NotesOf(const ImageSeriesInfo& info) {
    std::string text;
    for (const std::string& note : info.notes) text += note + "\n";
    return text;
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path();
};

TEST_F(MixedFolder, LeadsToItsCtWhateverElseLiesInIt) {
  WriteCt();
  EXPECT_EQ(NotesOf(ExpectCt()), "") << "nothing to tell of a folder of slices";
  const auto other = [&](const std::string& name, const std::string& sop_class, const std::string& modality,
                         const std::function<void(DicomFields&)>& change = {}) {
    DicomFields fields = SliceFields(2);
    fields.series = "7.7." + name;
    fields.sop_class = sop_class, fields.modality = modality;
    if (change) change(fields);
    Write("A-" + name, MakeDicom(fields));
  };
  const std::string kStorage = "1.2.840.10008.5.1.4.1.1.";
  other("seg", kStorage + "66.4", "SEG", [](DicomFields& f) {
    f.allocated = f.stored = 1, f.high = 0, f.is_signed = 0;
    f.dimensions = Element(0x28, 8, "IS", "12") + Element(0x28, 0x10, "US", Bytes<std::uint16_t>(6)) +
                   Element(0x28, 0x11, "US", Bytes<std::uint16_t>(8));
    f.pixels = std::string(72, '\x55');
  });
  other("dose", kStorage + "481.2", "RTDOSE",
        [](DicomFields& f) { f.allocated = f.stored = 32, f.high = 31; });
  other("structures", kStorage + "481.3", "RTSTRUCT");
  other("report", kStorage + "88.22", "SR");
  other("report2", kStorage + "88.67", "SR");
  other("keys", kStorage + "88.59", "KO");
  other("state", kStorage + "11.1", "PR");
  other("pdf", kStorage + "104.1", "DOC");
  other("raw", kStorage + "66", "CT");
  other("unknown", "1.2.3.4.5.6", "SEG");
  other("map", kStorage + "30", "MR");
  // pictures without a place: a secondary capture in colours, a dose report
  other("capture", kStorage + "7", "OT", [](DicomFields& f) {
    f.position = "", f.orientation = "", f.spacing = "";
    f.shown = "RGB", f.allocated = f.stored = 8, f.high = 7, f.is_signed = 0,
    f.pixels = std::string(144, '\7');
  });
  // a localizer
  other("scout", kStorage + "2", "CT", [](DicomFields& f) {
    f.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
    f.orientation = "1\\0\\0\\0\\0\\-1";
  });
  // what is no DICOM, what is broken, what is hidden
  Write("DICOMDIR", std::string(128, '\0') + "DICM" + Element(2, 2, "UI", "1.2.840.10008.1.3.10") +
                        Element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + Element(4, 0x1130, "CS", "DISK"));
  Write("README.txt", "about this scan");
  Write("Thumbs.db", std::string(100, '\1'));
  Write("thumbnail.jpg", "no picture at all");
  Write("VERSION", "");
  Write("desktop.ini", std::string("\x08\0", 2) + "what");
  Write(".DS_Store", "hidden");
  Write("B-broken", std::string(128, '\0') + "DICM");
  Write("C-broken", MakeDicom(SliceFields(2)).substr(0, 300));
  fs::create_directory(folder_ / "more");
  const ImageSeriesInfo info = ExpectCt();
  const std::string notes = NotesOf(info);
  for (const char* text :
       {"it alone is a volume", "localizer", "segmentations (SEG) (2)", "doses (RTDOSE) (1)",
        "sets of structures (RTSTRUCT) (1)", "reports (SR) (2)", "selections of key objects (KO) (1)",
        "presentation states (PR) (1)", "documents (1)", "raw data (1)", "parametric maps (1)",
        "lists of contents (DICOMDIR) (1)", "pictures that do not say where they lie (1)",
        "B-broken: it ends before the first element", "C-broken: "})
    EXPECT_THAT(notes, HasSubstr(text));
  EXPECT_THAT(notes, Not(HasSubstr("README")));
  // also where it is chosen by its number or id
  ImageSeriesOptions options;
  options.series = info.series;
  ExpectCt(options);
  options.series = info.series_id;
  ExpectCt(options);
  // and in the window's list
  const auto listed = ListSeries(folder_);
  ASSERT_TRUE(listed.ok()) << listed.error().Text();
  ASSERT_EQ(listed->size(), 2u);
  EXPECT_FALSE((*listed)[0].is_volume) << "the localizer";
  EXPECT_TRUE((*listed)[1].is_volume);
  EXPECT_FALSE((*listed)[1].problem);
  EXPECT_EQ((*listed)[1].preview.width, 8);
}

TEST_F(MixedFolder, ASliceThatCannotBeReadIsNotLeftOut) {
  WriteCt();
  const std::string whole = MakeDicom(SliceFields(6));
  Write("IM6", whole.substr(0, whole.size() - 10));  // at the end there would be no gap
  EXPECT_THAT(OpenText(), HasSubstr("E-IMG-011"));
  EXPECT_THAT(OpenText(), HasSubstr("IM6: "));
  const auto listed = ListSeries(folder_);
  ASSERT_TRUE(listed.ok());
  ASSERT_TRUE((*listed)[0].problem.has_value());
  EXPECT_THAT((*listed)[0].problem->message, HasSubstr("IM6: "));
  // a slice that does not even say of which series it is leaves a gap, and is named with it
  WriteCt();
  Write("IM3", MakeDicom(SliceFields(3)).substr(0, 200));
  EXPECT_THAT(OpenText(), HasSubstr("E-IMG-007"));
  EXPECT_THAT(OpenText(), HasSubstr("cannot be read is IM3"));
  // nor is one that does not say where it lies
  WriteCt();
  DicomFields fields = SliceFields(6);
  fields.position = "";
  Write("IM6", MakeDicom(fields));
  EXPECT_THAT(OpenText(), HasSubstr("slice 6 (IM6) does not say where it lies"));
}

TEST_F(MixedFolder, PhasesOfOneSeriesAreChosenByNumber) {
  WriteCt([](DicomFields& f) { f.acquisition = "1"; });
  WriteCt(
      [](DicomFields& f) {
        f.acquisition = "2", f.instance += 100;
        f.intercept = "-1000";
      },
      "V");
  const std::string asked = OpenText();
  EXPECT_THAT(asked, HasSubstr("E-IMG-006"));
  EXPECT_THAT(asked, HasSubstr("1 (CT, acquisition 1, slices: 6); 2 (CT, acquisition 2, slices: 6)"));
  ImageSeriesOptions options;
  options.series = 1;
  ExpectCt(options);
  options.series = 2;
  const auto second = ImageSeries::Open(folder_, options);
  ASSERT_TRUE(second.ok()) << second.error().Text();
  EXPECT_EQ(second->Info().slice_numbers.front(), 101);
  EXPECT_EQ(second->Info().grey_range[0], 100.0 - 1000);
  const auto listed = ListSeries(folder_);
  ASSERT_TRUE(listed.ok());
  ASSERT_EQ(listed->size(), 2u);
  EXPECT_EQ((*listed)[1].description, "CT, acquisition 2");
  EXPECT_EQ((*listed)[1].options.series, 2);
}

TEST_F(MixedFolder, CopiesOfAFileAreOneSlice) {
  WriteCt();
  for (int slice = 2; slice <= 4; ++slice)
    Write("IM" + std::to_string(slice) + " (copy)", MakeDicom(SliceFields(slice)));
  EXPECT_THAT(NotesOf(ExpectCt()), HasSubstr("copies of other slices (3)"));
}

TEST_F(MixedFolder, APreambleIsAnybodys) {
  for (const std::string& begin : {std::string("II*\0\xd0\7\0\0", 8), std::string("MM\0*\0\0\7\xd0", 8),
                                   std::string("\x89PNG\r\n\x1a\n"), std::string("\xff\xd8\xff\xe0"),
                                   std::string("NRRD0004\n"), std::string("\x1f\x8b\x08\0", 4)}) {
    WriteCt([&](DicomFields& f) { f.preamble.replace(0, begin.size(), begin); });
    ExpectCt();
    ImageSeriesOptions alone;
    alone.slice_mm = 2;
    EXPECT_TRUE(ImageSeries::Open(folder_ / "IM2", alone).ok()) << begin;
  }
  // whatever the file is called
  fs::remove_all(folder_);
  WriteCt([&](DicomFields& f) { f.preamble.replace(0, 4, std::string("II*\0", 4)); }, "dual.tif-");
  for (int slice = 1; slice <= kSlices; ++slice)
    fs::rename(folder_ / ("dual.tif-" + std::to_string(slice)),
               folder_ / ("dual" + std::to_string(slice) + ".tif"));
  ExpectCt();
}

TEST_F(MixedFolder, ElementsWithoutAPreambleAreDicom) {
  const auto rewrite = [&](const std::function<std::string(const std::string&)>& change) {
    for (int slice = 1; slice <= kSlices; ++slice) {
      DicomFields fields = SliceFields(slice);
      Write("IM" + std::to_string(slice), change(MakeDicom(fields)));
    }
  };
  const auto data_set = [](const std::string& file) { return file.find(std::string("\x08\0\x16\0UI", 6)); };
  rewrite([&](const std::string& file) { return file.substr(132); });
  ExpectCt();
  rewrite([&](const std::string& file) { return file.substr(data_set(file)); });
  ExpectCt();
  // only what looks like an element: eight bytes that begin with an 8 are no DICOM file
  EXPECT_FALSE(BeginsLikeDataSet(std::string("\x08\0\x05\0what is", 11)));
  EXPECT_FALSE(BeginsLikeDataSet(std::string("\x08\0", 2)));
  EXPECT_TRUE(BeginsLikeDataSet(std::string("\x08\0\0\0\4\0\0\0", 8)))
      << "a group's length, its type not written";
  EXPECT_TRUE(BeginsLikeDataSet(std::string("\x08\0\x05\0CS\x0a\0", 8)));
}

TEST_F(MixedFolder, ReadsDeflatedAndMislabelledElements) {
  const auto elements_of = [](const std::string& file) {
    return file.find(std::string("\x08\0\x16\0UI", 6));
  };
  const auto rewrite = [&](const std::string& syntax, const std::function<std::string(std::string)>& change) {
    for (int slice = 1; slice <= kSlices; ++slice) {
      DicomFields fields = SliceFields(slice);
      fields.transfer_syntax = syntax;
      const std::string file = MakeDicom(fields);
      Write("IM" + std::to_string(slice),
            file.substr(0, elements_of(file)) + change(file.substr(elements_of(file))));
    }
  };
  rewrite("1.2.840.10008.1.2.1.99", [](const std::string& plain) {
    const std::string packed = test::Zlib(plain);
    return packed.substr(2, packed.size() - 6);  // without the head and the sum of zlib
  });
  ExpectCt();
  // says implicit, is explicit
  rewrite("1.2.840.10008.1.2", [](const std::string& plain) { return plain; });
  ExpectCt();
  // zeros behind the pixels
  rewrite("1.2.840.10008.1.2.1", [](const std::string& plain) { return plain + std::string(512, '\0'); });
  ExpectCt();
  rewrite("1.2.840.10008.1.2.1", [](const std::string& plain) { return plain + "\r\n"; });
  ExpectCt();
}

/// The groups of an enhanced file that say where frame `slice` lies.
std::string FrameGroups(int slice, int phase) {
  const auto position = "-10\\-20\\" + std::to_string(30 + kStepMm * slice);
  return Sequence(0x20, 0x9111,
                  {Element(0x20, 0x9128, "UL", Bytes(static_cast<std::uint32_t>(phase))) +
                   Element(0x20, 0x9156, "US", Bytes<std::uint16_t>(1))}) +
         Sequence(0x20, 0x9113, {Element(0x20, 0x32, "DS", position)});
}
std::string SharedGroups() {
  return Sequence(0x20, 0x9116, {Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0")}) +
         Sequence(0x28, 0x9110, {Element(0x28, 0x30, "DS", "0.5\\0.5")}) +
         Sequence(0x28, 0x9145, {Element(0x28, 0x1052, "DS", "-1024") + Element(0x28, 0x1053, "DS", "1")});
}
/// An enhanced CT of these frames, as (slice, phase).
DicomFields EnhancedFields(const std::vector<std::pair<int, int>>& frames) {
  DicomFields fields;
  fields.sop_class = "1.2.840.10008.5.1.4.1.1.2.1";
  fields.position = fields.orientation = fields.spacing = "";
  fields.slope = fields.intercept = "";
  fields.dimensions = Element(0x28, 8, "IS", std::to_string(frames.size())) +
                      Element(0x28, 0x10, "US", Bytes<std::uint16_t>(6)) +
                      Element(0x28, 0x11, "US", Bytes<std::uint16_t>(8));
  std::vector<std::string> groups;
  for (const auto& [slice, phase] : frames) {
    groups.push_back(FrameGroups(slice, phase));
    for (int i = 0; i < 8 * 6; ++i)
      fields.pixels += Bytes(static_cast<std::int16_t>(100 * slice + i + (phase == 2 ? 1000 : 0)));
  }
  fields.palette = Sequence(0x5200, 0x9229, {SharedGroups()}) + Sequence(0x5200, 0x9230, groups);
  return fields;
}

TEST_F(MixedFolder, ReadsEnhancedCtOfOneFrameAFile) {
  for (int slice = 1; slice <= kSlices; ++slice) {
    DicomFields fields = EnhancedFields({{slice, 1}});
    fields.instance = slice;
    Write("E" + std::to_string(slice), MakeDicom(fields));
  }
  ExpectCt();
}

TEST_F(MixedFolder, ReadsEnhancedCtOfManyFrames) {
  // not in the order of their places
  Write("enhanced", MakeDicom(EnhancedFields({{3, 1}, {1, 1}, {2, 1}, {6, 1}, {5, 1}, {4, 1}})));
  ExpectCt();
  EXPECT_TRUE(ImageSeries::Open(folder_ / "enhanced").ok()) << "alone, too";
  // two phases in one file
  std::vector<std::pair<int, int>> frames;
  for (int slice = 1; slice <= kSlices; ++slice) {
    for (const int phase : {1, 2}) frames.push_back({slice, phase});
  }
  Write("enhanced", MakeDicom(EnhancedFields(frames)));
  EXPECT_THAT(OpenText(), HasSubstr("E-IMG-006"));
  EXPECT_THAT(OpenText(), HasSubstr("2 (CT, temporal position 2, slices: 6)"));
  ImageSeriesOptions options;
  options.series = 1;
  ExpectCt(options);
  options.series = 2;
  const auto second = ImageSeries::Open(folder_, options);
  ASSERT_TRUE(second.ok()) << second.error().Text();
  EXPECT_EQ(second->Info().grey_range[0], 1100.0 - 1024);
  const auto listed = ListSeries(folder_);
  ASSERT_TRUE(listed.ok());
  ASSERT_EQ(listed->size(), 2u);
  EXPECT_EQ((*listed)[1].preview.width, 8);
}

TEST_F(MixedFolder, FramesThatDoNotSayWhereTheyLieAreNoVolume) {
  DicomFields fields = EnhancedFields({{1, 1}, {2, 1}, {3, 1}});
  fields.palette = "";
  fields.position = "-10\\-20\\30", fields.orientation = "1\\0\\0\\0\\1\\0", fields.spacing = "0.5\\0.5";
  Write("cine", MakeDicom(fields));
  EXPECT_THAT(OpenText(), HasSubstr("E-IMG-009"));
  EXPECT_THAT(OpenText(), HasSubstr("slice 1 (cine, frame 1) does not say where it lies"));
}

TEST_F(MixedFolder, EachSliceHasItsOwnScale) {
  for (int slice = 1; slice <= 3; ++slice) {
    DicomFields fields = SliceFields(slice);
    fields.slope = std::to_string(slice), fields.intercept = "0";
    Write("IM" + std::to_string(slice), MakeDicom(fields));
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().grey_range, (std::array{100.0, 3.0 * 347}));
  EXPECT_EQ(series->ReadSlice(2, {2 * 221.0, 255})->At(5, 2)[0], 128);
}

TEST_F(MixedFolder, DistancesThatChangeAreInterpolated) {
  const double places[] = {0, 5, 10, 15, 17.5, 20, 22.5};
  for (int i = 0; i < 7; ++i) {
    DicomFields fields = SliceFields(i + 1);
    fields.position = "-10\\-20\\" + std::to_string(places[i]);
    fields.pixels.clear();
    // the value is 40 times the place
    for (int k = 0; k < 8 * 6; ++k) fields.pixels += Bytes(static_cast<std::int16_t>(40 * places[i]));
    fields.intercept = "0";
    Write("IM" + std::to_string(i), MakeDicom(fields));
  }
  const auto series = ImageSeries::Open(folder_);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const ImageSeriesInfo& info = series->Info();
  EXPECT_DOUBLE_EQ(info.slice_mm, 2.5);
  EXPECT_EQ(info.slice_numbers.size(), 10u);
  EXPECT_THAT(NotesOf(info),
              HasSubstr("slice distance changes (5 mm, then 2.5 mm): slices 2.5 mm apart were interpolated"));
  for (const int number : info.slice_numbers) {
    const auto picture = series->ReadSlice(number, {500, 1020});  // a shade for each 4
    ASSERT_TRUE(picture.ok());
    EXPECT_NEAR(picture->At(3, 3)[0], (100 * (number - 1) + 10) / 4.0, 1) << number;
  }
}

TEST_F(MixedFolder, ReportsBesidePicturesLeadToThePictures) {
  DicomFields report = SliceFields(1);
  report.sop_class = "1.2.840.10008.5.1.4.1.1.88.22";
  Write("report.dcm", MakeDicom(report));
  EXPECT_THAT(OpenText(), HasSubstr("E-IMG-002"));
  EXPECT_THAT(OpenText(), HasSubstr("hold no slices, but reports (SR);"));
  for (int i = 1; i <= 3; ++i) Write("s" + std::to_string(i) + ".png", test::MakePng(8, 6, 6));
  ImageSeriesOptions options;
  options.pixel_mm = 0.5, options.slice_mm = 2, options.axes = {"left", "posterior", "superior"};
  EXPECT_EQ(OpenText(options), "opened");
}

// Whatever is cut off, the answer is an error of the file, and true: no reader dies of it.
TEST_F(MixedFolder, EveryTruncationIsAnError) {
  DicomFields packed = SliceFields(1);
  packed.transfer_syntax = "1.2.840.10008.1.2.1.99";
  std::string deflated = MakeDicom(packed);
  const std::size_t elements = deflated.find(std::string("\x08\0\x16\0UI", 6));
  const std::string zlib = test::Zlib(deflated.substr(elements));
  deflated = deflated.substr(0, elements) + zlib.substr(2, zlib.size() - 6);
  const std::string plain = MakeDicom(SliceFields(1)), enhanced = MakeDicom(EnhancedFields({{1, 1}, {2, 1}}));
  ImportPool pool(ImportLimits(), 1);
  for (const std::string& whole : {plain, plain.substr(132), enhanced, deflated}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      std::ofstream(folder_ / "cut", std::ios::binary) << whole.substr(0, length);
      const auto file = ImportFile::Open(folder_ / "cut", Links::kRefuse);
      ASSERT_TRUE(file.ok());
      const auto reply = pool.Probe(*file);
      ASSERT_FALSE(reply.ok()) << length << " of " << whole.size();
      const bool is_cut = reply.error().code == ErrorCode::kImageTruncated;
      // before it shows what it is, it is nothing
      const bool is_unknown = length < 132 && reply.error().code == ErrorCode::kImageUndecodable;
      ASSERT_TRUE(is_cut || is_unknown) << length << " of " << whole.size() << ": " << reply.error().Text();
    }
  }
}

}  // namespace
}  // namespace trocar::images
