// SPDX-License-Identifier: Apache-2.0
// Label maps of every width, in the three formats of volumes, written here byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar/images/image_stack.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

using base::ErrorCode;
using testing::HasSubstr;

constexpr int kX = 4, kY = 3, kZ = 2;

template <typename Sample>
std::string Bytes(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) {
    const auto sample = static_cast<Sample>(value);
    bytes.append(reinterpret_cast<const char*>(&sample), sizeof sample);
  }
  return bytes;
}

struct TypeNames {
  std::int16_t nifti;
  const char *nrrd, *meta;
};
template <typename Sample>
TypeNames NamesOf() {
  if constexpr (std::is_same_v<Sample, std::uint8_t>) return {2, "uint8", "MET_UCHAR"};
  if constexpr (std::is_same_v<Sample, std::int16_t>) return {4, "int16", "MET_SHORT"};
  if constexpr (std::is_same_v<Sample, std::int32_t>) return {8, "int32", "MET_INT"};
  if constexpr (std::is_same_v<Sample, float>) return {16, "float", "MET_FLOAT"};
  if constexpr (std::is_same_v<Sample, double>) return {64, "double", "MET_DOUBLE"};
  if constexpr (std::is_same_v<Sample, std::uint16_t>) return {512, "uint16", "MET_USHORT"};
  if constexpr (std::is_same_v<Sample, std::uint32_t>) return {768, "uint32", "MET_UINT"};
  if constexpr (std::is_same_v<Sample, std::int64_t>) return {1024, "int64", "MET_LONG_LONG"};
}

template <typename T>
void Put(std::string& text, std::size_t at, T value) {
  std::memcpy(&text[at], &value, sizeof value);
}

template <typename Sample>
std::string FormatNifti(const std::vector<double>& values, float slope = 1, float intercept = 0) {
  std::string text(352, '\0');
  Put<std::int32_t>(text, 0, 348);
  const std::int16_t dims[8] = {3, kX, kY, kZ, 1, 1, 1, 1};
  std::memcpy(&text[40], dims, sizeof dims);
  Put<std::int16_t>(text, 70, NamesOf<Sample>().nifti);
  Put<std::int16_t>(text, 72, 8 * sizeof(Sample));
  const float sizes[8] = {1, 2, 2, 3, 1, 1, 1, 1};
  std::memcpy(&text[76], sizes, sizeof sizes);
  Put<float>(text, 108, 352);
  Put<float>(text, 112, slope);
  Put<float>(text, 116, intercept);
  Put<char>(text, 123, 2);          // mm
  Put<std::int16_t>(text, 254, 1);  // the rows below hold
  const float rows[12] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0};
  std::memcpy(&text[280], rows, sizeof rows);
  std::memcpy(&text[344], "n+1", 4);
  return text + Bytes<Sample>(values);
}

template <typename Sample>
std::string FormatNrrd(const std::vector<double>& values) {
  return std::string("NRRD0004\ntype: ") + NamesOf<Sample>().nrrd +
         "\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\nspace directions: (2,0,0) (0,2,0) "
         "(0,0,3)\n"
         "kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n" +
         Bytes<Sample>(values);
}

template <typename Sample>
std::string FormatMeta(const std::vector<double>& values) {
  return std::string(
             "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
             "CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\n"
             "ElementSpacing = 2 2 3\nDimSize = 4 3 2\nElementType = ") +
         NamesOf<Sample>().meta + "\nElementDataFile = LOCAL\n" + Bytes<Sample>(values);
}

class LabelMap : public testing::Test {
 protected:
  base::Result<LabelVolume> Read(const char* name, const std::string& content) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / name, content).ok());
    return ReadLabelVolume(folder_.Path() / name);
  }
  std::string Refusal(const char* name, const std::string& content) {
    const auto read = Read(name, content);
    EXPECT_FALSE(read.ok()) << name;
    if (read.ok()) return "";
    EXPECT_EQ(read.error().code, ErrorCode::kImageUndecodable);
    return read.error().message;
  }
  static std::vector<double> Values(double largest) {
    std::vector<double> values(kX * kY * kZ, 0.0);
    values[3] = 1, values[7] = largest, values[11] = largest - 1, values[20] = 2;
    return values;
  }

  template <typename Sample>
  void ExpectRead(double largest) {
    const std::vector<double> values = Values(largest);
    const std::vector<std::int32_t> expected(values.begin(), values.end());
    for (const auto& [name, content] :
         {std::pair{"a.nii", FormatNifti<Sample>(values)}, std::pair{"a.nrrd", FormatNrrd<Sample>(values)},
          std::pair{"a.mha", FormatMeta<Sample>(values)}}) {
      const auto read = Read(name, content);
      ASSERT_TRUE(read.ok()) << name << ": " << read.error().Text();
      EXPECT_EQ(read->labels, expected) << name << ", " << NamesOf<Sample>().nrrd;
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(LabelMap, IsReadInEveryWidth) {
  ExpectRead<std::uint8_t>(255);
  ExpectRead<std::int16_t>(32767);
  ExpectRead<std::uint16_t>(65535);
  ExpectRead<std::int32_t>(614'454'277);
  ExpectRead<std::int32_t>(kLargestLabel);
  ExpectRead<std::uint32_t>(kLargestLabel);
  ExpectRead<std::int64_t>(16'777'216);
  ExpectRead<float>(65536);
  ExpectRead<double>(16'777'216);
}

TEST_F(LabelMap, ObeysSlopeAndIntercept) {
  const auto read = Read("a.nii", FormatNifti<std::uint8_t>(Values(200), 500, 3));
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->labels[7], 100'003);
  EXPECT_EQ(read->labels[0], 3);
}

TEST_F(LabelMap, IsRefusedWithTheReason) {
  auto values = Values(9);
  values[7] = 2.5;
  EXPECT_THAT(Refusal("a.nii", FormatNifti<float>(values)), HasSubstr("2.5 is no whole number"));
  EXPECT_THAT(Refusal("a.nrrd", FormatNrrd<double>(values)), HasSubstr("2.5 is no whole number"));
  EXPECT_THAT(Refusal("a.mha", FormatMeta<float>(values)), HasSubstr("nearest neighbour"));
  values[7] = -1;
  EXPECT_THAT(Refusal("a.nii", FormatNifti<std::int16_t>(values)), HasSubstr("-1 is negative"));
  EXPECT_THAT(Refusal("a.nrrd", FormatNrrd<std::int32_t>(values)), HasSubstr("-1 is negative"));
  values[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Refusal("a.mha", FormatMeta<float>(values)), HasSubstr("no number"));
  values[7] = 4294967295.0;
  EXPECT_THAT(Refusal("a.nii", FormatNifti<std::uint32_t>(values)),
              HasSubstr("4294967295 is larger than 2147483647"));
  // two labels beyond 2^24 may be one as floating point: never taken without a word
  values[7] = 16'777'218;
  EXPECT_THAT(Refusal("a.nrrd", FormatNrrd<float>(values)), HasSubstr("32-bit integers"));
  EXPECT_THAT(Refusal("a.nii", FormatNifti<std::int64_t>(values)), HasSubstr("is larger than 16777216"));
}

/// Segments in layers as 3D Slicer saves them when they overlap: the layers are the first axis.
std::string FormatLayers(int layers, const std::string& segments, const std::vector<double>& interleaved) {
  return "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: " +
         std::to_string(layers) +
         " 4 3 2\nspace directions: none (2,0,0) (0,2,0) (0,0,3)\nkinds: list domain domain domain\n"
         "encoding: raw\nspace origin: (0,0,0)\n" +
         segments + "\n" + Bytes<std::uint8_t>(interleaved);
}

const char* const kTwoLayers =
    "Segment0_Name:=liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
    "Segment1_Name:=gallbladder\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n"
    "Segment2_Name:=spleen\nSegment2_LabelValue:=2\nSegment2_Layer:=0\n";

TEST_F(LabelMap, JoinsLayersOfSegmentsThatOverlap) {
  std::vector<double> layers(2 * kX * kY * kZ, 0.0);
  for (const std::size_t voxel : {3u, 4u, 5u, 6u}) layers[2 * voxel] = 1;  // liver
  for (const std::size_t voxel : {6u, 7u}) layers[2 * voxel + 1] = 1;  // gallbladder, one voxel in the liver
  layers[2 * 20] = 2;                                                  // spleen
  const auto read = Read("two.seg.nrrd", FormatLayers(2, kTwoLayers, layers));
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->size, (std::array<int, 3>{kX, kY, kZ}));
  EXPECT_EQ(read->direction[2][2], 3);
  std::vector<std::int32_t> expected(kX * kY * kZ, 0);
  expected[3] = expected[4] = expected[5] = 1;
  expected[6] = expected[7] = 2;  // the smaller one keeps what both have
  expected[20] = 3;
  EXPECT_EQ(read->labels, expected);
  EXPECT_EQ(read->names,
            (std::vector<std::pair<std::string, int>>{{"liver", 1}, {"gallbladder", 2}, {"spleen", 3}}));
}

// Before version 4.11 3D Slicer said neither label nor layer; other programs call the axis a vector, or put it last.
TEST_F(LabelMap, TakesLayersOfOlderAndOtherWriters) {
  std::vector<double> layers(3 * kX * kY * kZ, 0.0), planes = layers;
  for (const std::size_t voxel : {3u, 4u, 5u, 6u}) layers[3 * voxel] = 1;
  for (const std::size_t voxel : {6u, 7u}) layers[3 * voxel + 1] = 1;
  layers[3 * 20 + 2] = 1;
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i % 3 * kX * kY * kZ + i / 3] = layers[i];
  const std::string old =
      "Segment0_ID:=a\nSegment0_Name:=liver\nSegment1_ID:=b\nSegment1_Name:=gallbladder\nSegment2_ID:="
      "spleen\n";
  const std::string said =
      "Segment0_Name:=liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
      "Segment1_Name:=gallbladder\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n"
      "Segment2_Name:=spleen\nSegment2_LabelValue:=1\nSegment2_Layer:=2\n";
  const auto with = [](std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
  };
  const std::string as_list = FormatLayers(3, old, layers);
  const std::string last = with(with(with(FormatLayers(3, said, planes), "3 4 3 2", "4 3 2 3"),
                                     "none (2,0,0) (0,2,0) (0,0,3)", "(2,0,0) (0,2,0) (0,0,3) none"),
                                "list domain domain domain", "domain domain domain list");
  const std::pair<const char*, std::string> files[] = {
      {"old.seg.nrrd", as_list},
      {"vector.seg.nrrd", with(FormatLayers(3, said, layers), "list", "vector")},
      {"without_kinds.seg.nrrd", with(as_list, "kinds: list domain domain domain\n", "")},
      {"last.seg.nrrd", last},
      {"last_vector.seg.nrrd", with(last, "list", "vector")},
  };
  std::vector<std::int32_t> expected(kX * kY * kZ, 0);
  expected[3] = expected[4] = expected[5] = 1;
  expected[6] = expected[7] = 2;
  expected[20] = 3;
  for (const auto& [name, content] : files) {
    const auto read = Read(name, content);
    ASSERT_TRUE(read.ok()) << name << ": " << read.error().Text();
    EXPECT_EQ(read->labels, expected) << name;
    EXPECT_EQ(read->direction[2][2], 3) << name;
    EXPECT_EQ(read->names,
              (std::vector<std::pair<std::string, int>>{{"liver", 1}, {"gallbladder", 2}, {"spleen", 3}}))
        << name;
  }
}

TEST_F(LabelMap, TakesOneSegmentOfAnOlderWriter) {
  const auto values = Values(1);
  std::string file = FormatNrrd<std::uint8_t>(values);
  file.insert(file.find("\n\n") + 1, "Segment0_ID:=Segment_1\nSegment0_Name:=li\\\\ver\n");
  const auto read = Read("one.seg.nrrd", file);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->names, (std::vector<std::pair<std::string, int>>{{"li\\ver", 1}}));
  EXPECT_EQ(read->labels[7], 1);
}

TEST_F(LabelMap, SaysHowADicomSegmentationIsRead) {
  test::DicomFields fields;
  fields.sop_class = "1.2.840.10008.5.1.4.1.1.66.4", fields.modality = "SEG";
  const auto read = Read("seg.dcm", test::MakeDicom(fields));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kImageUnsupported);
  EXPECT_THAT(read.error().message, HasSubstr("export it from 3D Slicer as .seg.nrrd"));
}

// 3D Slicer says of each segment what it is in SNOMED
TEST_F(LabelMap, KeepsTheCodesOfSegments) {
  const std::string list = "3D Slicer General Anatomy list", organ = "~SCT^123037004^Anatomical Structure";
  const std::string tags[] = {
      "TerminologyEntry:" + list + organ + "~SCT^10200004^Liver~^^~Anatomic codes - DICOM master list~^^~^^|",
      "Segmentation.Status:inprogress|TerminologyEntry:" + list +
          "~SRT^T-D000A^Anatomical Structure~SRT^T-71000^Kidney~SRT^G-A100^Right~list~^^~^^|",
      "TerminologyEntry:" + list +
          "~SCT^49755003^Morphologically Altered "
          "Structure~SCT^108369006^Neoplasm~^^~list~SCT^10200004^Liver~^^"};
  const auto with_tags = [&](const char* layer) {
    std::string text;
    for (int i = 0; i < 3; ++i) {
      const std::string segment = "Segment" + std::to_string(i);
      text += segment + "_Name:=Segment_" + std::to_string(i + 1) + "\n" + segment +
              "_LabelValue:=" + std::to_string(i + 1) + "\n" + segment + "_Layer:=" + layer + "\n" + segment +
              "_Tags:=" + tags[i] + "\n";
    }
    return text;
  };
  const std::vector<std::pair<std::string, int>> codes = {
      {"10200004", 1}, {"T-71000 G-A100", 2}, {"108369006 @10200004", 3}};
  const std::vector<double> layers(2 * kX * kY * kZ, 1.0);
  const auto layered = Read("layers.nrrd", FormatLayers(2, with_tags("1"), layers));
  ASSERT_TRUE(layered.ok()) << layered.error().Text();
  EXPECT_EQ(layered->codes, codes);
  const auto bad =
      Read("bad.nrrd", FormatLayers(2,
                                    "Segment0_Name:=a\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
                                    "Segment0_Tags:=TerminologyEntry:a~SCT^1^b~FMA^7197^Liver~^^\n"
                                    "Segment1_Name:=b\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n"
                                    "Segment1_Tags:=TerminologyEntry:a~b~SCT^10200004\\n;x^Liver\n",
                                    layers));
  ASSERT_TRUE(bad.ok()) << bad.error().Text();
  EXPECT_TRUE(bad->codes.empty()) << "another scheme, and what is no code";
}

TEST_F(LabelMap, RefusesLayersThatSayNothing) {
  const std::vector<double> layers(2 * kX * kY * kZ, 1.0);
  EXPECT_THAT(Refusal("bare.nrrd", FormatLayers(2, "", layers)), HasSubstr("which label of which layer"));
  EXPECT_THAT(
      Refusal("odd.nrrd", FormatLayers(2,
                                       "Segment0_Name:=liver\nSegment0_LabelValue:=1\n"
                                       "Segment1_Name:=lost\nSegment1_LabelValue:=1\nSegment1_Layer:=2\n",
                                       layers)),
      HasSubstr("one of its segments lies in layer 2, and it has 2"));
  EXPECT_EQ(Read("many.nrrd", FormatLayers(65, kTwoLayers, layers)).error().code, ErrorCode::kImageTooLarge);
  EXPECT_EQ(Read("cut.nrrd", FormatLayers(3, kTwoLayers, layers)).error().code, ErrorCode::kImageTruncated);
  EXPECT_TRUE(Read("two.nrrd", FormatLayers(2, kTwoLayers, layers)).ok());
  for (const auto& [name, why] : {std::pair{"two.nrrd", "segments in layers, no image"},
                                  {"bare.nrrd", "a list of 2 values a voxel, no image"}}) {
    const auto series = ImageSeries::Open(folder_.Path() / name, {});
    ASSERT_FALSE(series.ok());
    EXPECT_EQ(series.error().code, ErrorCode::kImageUnsupported);
    EXPECT_THAT(series.error().message, HasSubstr(why));
  }
}

}  // namespace
}  // namespace trocar::images
