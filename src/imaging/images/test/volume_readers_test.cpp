// SPDX-License-Identifier: Apache-2.0
// Volumes as the writers of the three formats leave them (NIfTI, NRRD, MetaImage): the same 8 x 6 x 4 samples, steps of 0.5, 0.5 and
// 2 mm and directions, said in every way that their reference readers take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import_worker.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr;

/// Files of one case by their names; the first is opened.
using Files = std::vector<std::pair<std::string, std::string>>;

struct Case {
  std::string name;
  Files files;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

template <typename Number>
void Swap(std::string& file, std::size_t at) {
  std::reverse(file.begin() + static_cast<std::ptrdiff_t>(at),
               file.begin() + static_cast<std::ptrdiff_t>(at + sizeof(Number)));
}

std::string SwappedSamples() {
  std::string samples = Samples(8, 6, 4);
  for (std::size_t i = 0; i < samples.size(); i += 2) std::swap(samples[i], samples[i + 1]);
  return samples;
}

std::string TextOfSamples(const char* separator) {
  std::string text;
  for (int z = 0; z < 4; ++z) {
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) text += std::to_string(Sample(x, y, z)) + separator;
    }
  }
  return text;
}

std::string HexOfSamples() {
  std::string text;
  for (const unsigned char byte : Samples(8, 6, 4)) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[byte / 16];
    text += kDigits[byte % 16];
    if (text.size() % 61 == 60) text += '\n';
  }
  return text;
}

std::string WithCarriageReturns(const std::string& lines) {
  std::string text;
  for (const char c : lines) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return text;
}

/// A NIfTI-1 file with one change.
template <typename Number>
std::string NiftiWith(std::size_t at, Number number) {
  std::string file = MakeNifti();
  Put(file, at, number);
  return file;
}

/// Its lengths in another unit.
std::string NiftiInUnit(char code, float scale) {
  std::string file = MakeNifti();
  file[123] = code;
  for (std::size_t at = 80; at < 92; at += 4) {
    float length = 0;
    std::memcpy(&length, &file[at], 4);
    Put(file, at, length * scale);
  }
  for (std::size_t at = 280; at < 328; at += 4) {
    float length = 0;
    std::memcpy(&length, &file[at], 4);
    Put(file, at, length * scale);
  }
  return file;
}

/// Placed by its qform: half a turn about y, mirrored (qfac -1); rows of the sform are zero where it has one.
std::string NiftiByQform(std::int16_t sform, float c = 1, float qfac = -1) {
  std::string file = MakeNifti();
  Put<std::int16_t>(file, 252, 1);
  Put<std::int16_t>(file, 254, sform);
  Put<float>(file, 76, qfac);
  Put<float>(file, 260, c);
  Put<float>(file, 268, 10), Put<float>(file, 272, -20), Put<float>(file, 276, 30);
  for (std::size_t at = 280; at < 328; at += 4) Put<float>(file, at, 0);
  return file;
}

std::string NiftiBigEndian() {
  std::string file = MakeNifti();
  Swap<std::int32_t>(file, 0);
  for (std::size_t at = 40; at < 56; at += 2) Swap<std::int16_t>(file, at);
  for (const std::size_t at : {70u, 72u, 252u, 254u}) Swap<std::int16_t>(file, at);
  for (std::size_t at = 76; at < 120; at += 4) Swap<float>(file, at);
  for (std::size_t at = 280; at < 328; at += 4) Swap<float>(file, at);
  return file.substr(0, 352) + SwappedSamples();
}

std::string Nifti2(const char* mark) {
  std::string file(544, '\0');
  Put<std::int32_t>(file, 0, 540);
  file.replace(4, 8, std::string(mark, 3) + std::string("\0\r\n\032\n", 5));
  Put<std::int16_t>(file, 12, 4);
  const std::int64_t sides[] = {3, 8, 6, 4, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) Put(file, 16 + 8 * i, sides[i]);
  Put<std::int64_t>(file, 168, mark[1] == '+' ? 544 : 0);
  Put<std::int32_t>(file, 348, 1);
  const double rows[3][4] = {{-0.5, 0, 0, 10}, {0, 0.5, 0, -20}, {0, 0, 2, 30}};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t k = 0; k < 4; ++k) Put(file, 400 + 32 * r + 8 * k, rows[r][k]);
  }
  Put<std::int32_t>(file, 500, 2 | 8);
  return file;
}

/// The header of a pair of files.
std::string NiftiHdr(float begin = 0) {
  std::string file = MakeNifti().substr(0, 352);
  Put<float>(file, 108, begin);
  file.replace(344, 4, std::string("ni1\0", 4));
  return file;
}

std::string NiftiWithExtension() {
  std::string file = MakeNifti();
  file[348] = 1;
  Put<float>(file, 108, 352 + 32);
  const std::string extension = Bytes<std::int32_t>(32) + Bytes<std::int32_t>(6) + std::string(24, 'x');
  return file.substr(0, 352) + extension + file.substr(352);
}

std::vector<Case> NiftiCases() {
  const std::string plain = MakeNifti(), header = plain.substr(0, 352), samples = plain.substr(352);
  std::string four = plain, seven = plain, negative = plain, unset = NiftiWith<float>(108, 0);
  Put<std::int16_t>(four, 40, 4), Put<std::int16_t>(four, 48, 0);
  Put<std::int16_t>(seven, 40, 7);
  Put<std::int16_t>(negative, 40, 5), Put<std::int16_t>(negative, 50, -3);
  return {
      {"Plain", {{"a.nii", plain}}},
      {"SlopeNan", {{"a.nii", NiftiWith(112, std::nanf(""))}}},
      {"SlopeInfinite", {{"a.nii", NiftiWith(112, HUGE_VALF)}}},
      {"SlopeZero", {{"a.nii", NiftiWith<float>(112, 0)}}},
      {"FourthSideZero", {{"a.nii", four}}},
      {"SevenDimensions", {{"a.nii", seven}}},
      {"NegativeTrailingSide", {{"a.nii", negative}}},
      {"UnitNotSaid", {{"a.nii", NiftiInUnit(0, 1)}}},
      {"Metres", {{"a.nii", NiftiInUnit(1, 1e-3f)}}},
      {"Micrometres", {{"a.nii", NiftiInUnit(3, 1e3f)}}},
      {"MillimetresAndSeconds", {{"a.nii", NiftiInUnit(2 | 8, 1)}}},
      {"SformOfZerosAndQform", {{"a.nii", NiftiByQform(1)}}},
      {"QformAlone", {{"a.nii", NiftiByQform(0)}}},
      {"QformOfRoundedNumbers", {{"a.nii", NiftiByQform(0, 1.0002f)}}},
      {"BeginNotSaid", {{"a.nii", unset}}},
      {"BeginNotSaidAndPacked", {{"a.nii.gz", Gzip(unset)}}},
      {"BeginNotSaidRightBehindTheHeader", {{"a.nii", unset.substr(0, 348) + samples}}},
      {"BeginNotSaidRightBehindTheHeaderAndPacked", {{"a.nii.gz", Gzip(unset.substr(0, 348) + samples)}}},
      {"BigEndian", {{"a.nii", NiftiBigEndian()}}},
      {"Second", {{"a.nii", Nifti2("n+2") + samples}}},
      {"Packed", {{"a.nii.gz", Gzip(plain)}}},
      {"PackedWithAnotherName", {{"a.nii", Gzip(plain)}}},
      {"PackedInTwoParts", {{"a.nii.gz", Gzip(plain.substr(0, 400)) + Gzip(plain.substr(400))}}},
      {"NotPackedWithAnotherName", {{"a.nii.gz", plain}}},
      {"WithExtension", {{"a.nii", NiftiWithExtension()}}},
      {"Pair", {{"a.hdr", NiftiHdr()}, {"a.img", samples}}},
      {"PairByItsSamples", {{"a.img", samples}, {"a.hdr", NiftiHdr()}}},
      {"PairThatBeginsLater", {{"a.hdr", NiftiHdr(16)}, {"a.img", std::string(16, 'x') + samples}}},
      {"PairPacked", {{"a.hdr", NiftiHdr()}, {"a.img.gz", Gzip(samples)}}},
      {"PairBothPacked", {{"a.hdr.gz", Gzip(NiftiHdr())}, {"a.img.gz", Gzip(samples)}}},
      {"PairInCapitals", {{"A.HDR", NiftiHdr()}, {"A.IMG", samples}}},
      {"SecondPair", {{"a.hdr", Nifti2("ni2")}, {"a.img", samples}}},
  };
}

/// A detached header of NRRD and its data.
Files Detached(const std::vector<std::string>& lines, const std::string& samples) {
  return {{"a.nhdr", MakeNrrd(lines, false)}, {"a.raw", samples}};
}

std::string Nrrd(const std::vector<std::string>& lines, const std::string& samples) {
  return MakeNrrd(lines, false) + "\n" + samples;
}

std::string NrrdInUnit(const std::string& units, const char* directions, const char* origin = "(1,2,3)") {
  return MakeNrrd({"space directions: " + std::string(directions), "space origin: " + std::string(origin),
                   "space units: " + units});
}

std::vector<Case> NrrdCases() {
  const std::string samples = Samples(8, 6, 4), plain = MakeNrrd();
  const std::string fields = plain.substr(0, plain.find("\n\n") + 1);
  const std::string four =
      MakeNrrd({"dimension: 4", "sizes: 8 6 4 1", "kinds: domain domain domain time", "space: LPST",
                "space directions: (0.5,0,0,0) (0,0.5,0,0) (0,0,2,0) (0,0,0,1)", "space origin: (1,2,3,0)",
                "space units: \"mm\" \"mm\" \"mm\" \"s\""});
  std::vector<Case> cases = {
      {"Plain", {{"a.nrrd", plain}}},
      {"Centimetres",
       {{"a.nrrd", NrrdInUnit("\"cm\" \"cm\" \"cm\"", "(0.05,0,0) (0,0.05,0) (0,0,0.2)", "(0.1,0.2,0.3)")}}},
      {"Micrometres",
       {{"a.nrrd", NrrdInUnit("\"um\" \"um\" \"um\"", "(500,0,0) (0,500,0) (0,0,2000)", "(1e3,2e3,3e3)")}}},
      {"MicrometresInGreek",
       {{"a.nrrd", NrrdInUnit("\"\xc2\xb5m\" \"\xce\xbcm\" \"microns\"", "(500,0,0) (0,500,0) (0,0,2000)",
                              "(1e3,2e3,3e3)")}}},
      {"Metres",
       {{"a.nrrd", NrrdInUnit("\"m\" \"meters\" \"metre\"", "(0.0005,0,0) (0,0.0005,0) (0,0,0.002)",
                              "(.001,.002,.003)")}}},
      {"Inches",
       {{"a.nrrd", NrrdInUnit("\"in\" \"inch\" \"inches\"",
                              "(0.01968503937,0,0) (0,0.01968503937,0) (0,0,0.07874015748)",
                              "(0.03937007874,0.07874015748,0.11811023622)")}}},
      {"MillimetresAndAGapInTheUnits",
       {{"a.nrrd", NrrdInUnit("\"mm\" \"\" \"???\"", "(0.5,0,0) (0,0.5,0) (0,0,2)")}}},
      {"UnitsDiffer",
       {{"a.nrrd", NrrdInUnit("\"cm\" \"mm\" \"m\"", "(0.05,0,0) (0,0.5,0) (0,0,0.002)", "(.1,2,.003)")}}},
      {"UnitsOfTheAxes",
       {{"a.nrrd", MakeNrrd({"space directions: (0.05,0,0) (0,0.05,0) (0,0,0.2)", "space origin: (.1,.2,.3)",
                             "units: \"cm\" \"cm\" \"cm\""})}}},
      {"SpaceInCapitals", {{"a.nrrd", MakeNrrd({"space: LPS"})}}},
      {"SpaceWithBlanks", {{"a.nrrd", MakeNrrd({"space: left posterior superior"})}}},
      {"OtherSpace",
       {{"a.nrrd", MakeNrrd({"space: RAS", "space directions: (-0.5,0,0) (0,-0.5,0) (0,0,2)",
                             "space origin: (-1,-2,3)"})}}},
      {"FourWithTime", {{"a.nrrd", four}}},
      {"FourWithoutKinds",
       {{"a.nrrd",
         MakeNrrd({"dimension: 4", "sizes: 8 6 4 1", "space directions: (.5,0,0) (0,.5,0) (0,0,2) none"})}}},
      {"FourWithAListOfOne",
       {{"a.nrrd", MakeNrrd({"dimension: 4", "sizes: 1 8 6 4", "kinds: list domain domain domain",
                             "space directions: none (.5,0,0) (0,.5,0) (0,0,2)"})}}},
      {"FourWithNumbersThatAreNone",
       {{"a.nrrd", MakeNrrd({"dimension: 4", "sizes: 1 8 6 4", "kinds: stub space space space",
                             "space directions: (nan,nan,nan) ( 0.5, 0, 0 ) (0,0.5,0) (0,0,2)"})}}},
      {"CarriageReturns", {{"a.nrrd", WithCarriageReturns(fields + "\n") + samples}}},
      {"OldestMark", {{"a.nrrd", "NRRD00.01" + plain.substr(8)}}},
      {"NewestMark", {{"a.nrrd", "NRRD0005" + plain.substr(8)}}},
      {"CommentsAndKeys",
       {{"a.nrrd", Nrrd({"# a: comment", "DICOM:0010:=a", "DICOM:0020:=b", "my key: of mine:=1",
                         "my key: of theirs:=2", "note:=it\\nhas\\\\two lines", "another program: 1"},
                        samples)}}},
      {"NamesWithoutBlanks",
       {{"a.nhdr", MakeNrrd({"spaceunits: \"mm\" \"mm\" \"mm\"", "centers: cell node ???", "byteskip: 0",
                             "datafile: a.raw"},
                            false)},
        {"a.raw", samples}}},
      {"MeasurementFrameAndOthers",
       {{"a.nrrd",
         Nrrd({"measurement frame: (1,0,0) (0,1,0) (0,0,1)", "old min: 0", "old max: 9", "content: x:=y",
               "number: 192", "sample units: HU", "labels: \"x\" \"y\" \"z\"", "thicknesses: nan nan 2"},
              samples)}}},
      {"Gzip", {{"a.nrrd", Nrrd({"encoding: gzip"}, Gzip(samples))}}},
      {"Gz", {{"a.nrrd", Nrrd({"encoding: gz"}, Gzip(samples))}}},
      {"Text", {{"a.nrrd", Nrrd({"encoding: text"}, TextOfSamples(" "))}}},
      {"TextWithCommas", {{"a.nrrd", Nrrd({"encoding: ascii"}, TextOfSamples(",\n"))}}},
      {"TextDetached", Detached({"encoding: txt", "data file: a.raw"}, TextOfSamples("\t"))},
      {"Hexadecimal", {{"a.nrrd", Nrrd({"encoding: hex"}, HexOfSamples())}}},
      {"BigEndian", {{"a.nrrd", Nrrd({"endian: big"}, SwappedSamples())}}},
      {"DotSlash", Detached({"data file: ./a.raw"}, samples)},
      {"Folder",
       {{"a.nhdr", MakeNrrd({"data file: ./data//deep/a.raw"}, false)}, {"data/deep/a.raw", samples}}},
      {"FolderAndBack", Detached({"data file: data/../a.raw"}, samples)},
      {"ListOfOne", {{"a.nhdr", MakeNrrd({"data file: LIST"}, false) + "a.raw\n"}, {"a.raw", samples}}},
      {"NameThatBeginsLikeAList",
       {{"a.nhdr", MakeNrrd({"data file: LISTED.raw"}, false)}, {"LISTED.raw", samples}}},
      {"NameWithPercent", {{"a.nhdr", MakeNrrd({"data file: 50%.raw"}, false)}, {"50%.raw", samples}}},
      {"LineSkip", Detached({"line skip: 2", "data file: a.raw"}, "one\ntwo\n" + samples)},
      {"LineSkipAttached", {{"a.nrrd", Nrrd({"line skip: 1", "byte skip: 3"}, "one\nxyz" + samples)}}},
      {"ByteSkip", Detached({"byte skip: 5", "data file: a.raw"}, "12345" + samples)},
      {"ByteSkipFromTheEnd", Detached({"byte skip: -1", "data file: a.raw"}, "12345" + samples)},
      {"ByteSkipFromTheEndAttached", {{"a.nrrd", Nrrd({"byte skip: -1"}, "12345" + samples)}}},
      {"ByteSkipWithSomethingBehind",
       Detached({"byte skip: -4", "data file: a.raw"}, "12345" + samples + "abc")},
      {"ByteSkipInGzip",
       Detached({"encoding: gzip", "byte skip: 5", "data file: a.raw"}, Gzip("12345" + samples))},
      {"ByteSkipFromTheEndOfGzip",
       Detached({"encoding: gzip", "byte skip: -1", "data file: a.raw"}, Gzip("12345" + samples))},
      {"ByteSkipFromTheEndOfTwoGzips",
       Detached({"encoding: gzip", "byte skip: -1", "data file: a.raw"},
                Gzip("12345" + samples.substr(0, 9)) + Gzip(samples.substr(9)))},
      {"LineSkipBeforeGzip",
       Detached({"encoding: gzip", "line skip: 1", "data file: a.raw"}, "one\n" + Gzip(samples))},
      {"BehindNifti",
       {{"a.nhdr", MakeNrrd({"encoding: gzip", "byte skip: -1", "data file: x.nii.gz"}, false)},
        {"x.nii.gz", Gzip(MakeNifti())}}},
  };
  for (const char* type : {"short int", "signed short", "signed short int", "int16", "INT16_T"})
    cases.push_back({std::string("Type") + std::to_string(cases.size()),
                     {{"a.nrrd", MakeNrrd({std::string("type: ") + type})}}});
  return cases;
}

Files DetachedMeta(const std::vector<std::string>& lines, const std::string& samples) {
  return {{"a.mhd", MakeMetaImage(lines, "a.raw")}, {"a.raw", samples}};
}

std::string Meta(const std::vector<std::string>& lines, const std::string& samples) {
  const std::string file = MakeMetaImage(lines), local = "LOCAL\n";
  return file.substr(0, file.find(local) + local.size()) + samples;
}

std::string MetaInUnit(const char* unit, const char* spacing, const char* offset) {
  return MakeMetaImage({"DistanceUnits = " + std::string(unit), "ElementSpacing = " + std::string(spacing),
                        "Offset = " + std::string(offset)});
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

std::vector<Case> MetaCases() {
  const std::string samples = Samples(8, 6, 4), plain = MakeMetaImage();
  const std::string head = plain.substr(0, plain.size() - samples.size());
  const std::vector<std::string> four = {"NDims = 4", "DimSize = 8 6 4 1", "ElementSpacing = 0.5 0.5 2 1",
                                         "Offset = 1 2 3 0",
                                         "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"};
  std::string detached = MakeMetaImage({}, "a.raw"), colons = head;
  for (auto at = colons.find(" ="); at != std::string::npos; at = colons.find(" ="))
    colons.replace(at, 2, ":");
  std::vector<Case> cases = {
      {"Plain", {{"a.mha", plain}}},
      {"FourDimensions", {{"a.mha", MakeMetaImage(four)}}},
      {"NoLineEndAtTheEnd", {{"a.mhd", detached.substr(0, detached.size() - 1)}, {"a.raw", samples}}},
      {"DotSlash", {{"a.mhd", MakeMetaImage({}, "./a.raw")}, {"a.raw", samples}}},
      {"Folder", {{"a.mhd", MakeMetaImage({}, "data/a.raw")}, {"data/a.raw", samples}}},
      {"CarriageReturns", {{"a.mha", WithCarriageReturns(head) + samples}}},
      {"Colons", {{"a.mha", colons + samples}}},
      {"NoBlanks",
       {{"a.mha", Replaced(Replaced(head, "NDims = 3", "NDims=3"), "DimSize = ", "DimSize=") + samples}}},
      {"CommentFirst", {{"a.mha", "Comment=made here\nComment=twice\n" + plain}}},
      {"NameFirst", {{"a.mha", "Name = belly\n" + plain}}},
      {"WithoutObjectType", {{"a.mha", plain.substr(plain.find('\n') + 1)}}},
      {"Centimetres", {{"a.mha", MetaInUnit("cm", "0.05 0.05 0.2", "0.1 0.2 0.3")}}},
      {"Micrometres", {{"a.mha", MetaInUnit("um", "500 500 2000", "1000 2000 3000")}}},
      {"Millimetres", {{"a.mha", MetaInUnit("mm", "0.5 0.5 2", "1 2 3")}}},
      {"UnitLeftOpen", {{"a.mha", MetaInUnit("?", "0.5 0.5 2", "1 2 3")}}},
      {"ElementSize", {{"a.mha", Replaced(head, "ElementSpacing", "ElementSize") + samples}}},
      {"ElementSizeBesideSpacing", {{"a.mha", MakeMetaImage({"ElementSize = 9 9 9"})}}},
      {"Rotation", {{"a.mha", Replaced(head, "TransformMatrix", "Rotation") + samples}}},
      {"OrientationAndPosition",
       {{"a.mha",
         Replaced(Replaced(head, "TransformMatrix", "Orientation"), "Offset", "Position") + samples}}},
      {"SaidTwiceAlike", {{"a.mha", MakeMetaImage({"Origin = 1 2 3", "Position = 1 2 3.0"})}}},
      {"NewerNames",
       {{"a.mha", MakeMetaImage({"FileFormatVersion = 1", "ElementDirection = 1 0 0 0 1 0 0 0 1",
                                 "ElementOrigin = 1 2 3", "Offset = 7 7 7"})}}},
      {"DirectionsThatAreNoUnits",
       {{"a.mha", MakeMetaImage({"TransformMatrix = 2 0 0 0 0.5 0 0 0 4", "ElementSpacing = 0.25 1 0.5"})}}},
      {"Text", {{"a.mha", Meta({"BinaryData = False"}, TextOfSamples(" "))}}},
      {"TextDetached", DetachedMeta({"BinaryData = False"}, TextOfSamples("\n"))},
      {"WithoutBinaryData", {{"a.mha", Replaced(plain, "BinaryData = True\n", "")}}},
      {"Packed", {{"a.mha", Meta({"CompressedData = True"}, Zlib(samples))}}},
      {"PackedWithItsSize",
       {{"a.mha",
         Meta({"CompressedData = True", "CompressedDataSize = " + std::to_string(Zlib(samples).size())},
              Zlib(samples))}}},
      {"HeaderSize", DetachedMeta({"HeaderSize = 5"}, "12345" + samples)},
      {"HeaderSizeFromTheEnd", DetachedMeta({"HeaderSize = -1"}, "12345" + samples)},
      {"HeaderSizeFromTheEndLocal", {{"a.mha", Meta({"HeaderSize = -1"}, "12345" + samples)}}},
      {"BigEndian", {{"a.mha", Meta({"BinaryDataByteOrderMSB = True"}, SwappedSamples())}}},
      {"BigEndianByItsOtherName",
       {{"a.mha",
         Replaced(Meta({}, SwappedSamples()), "BinaryDataByteOrderMSB = False", "ElementByteOrderMSB = 1")}}},
      {"ListOfOne", {{"a.mhd", MakeMetaImage({}, "LIST") + "a.raw\n"}, {"a.raw", samples}}},
      {"OneChannel", {{"a.mha", MakeMetaImage({"ElementNumberOfChannels = 1"})}}},
      {"Intensities",
       {{"a.mha",
         MakeMetaImage({"ElementToIntensityFunctionSlope = 1.0", "ElementToIntensityFunctionOffset = 0"})}}},
      {"OrientationInLetters",
       {{"a.mha", MakeMetaImage({"AnatomicalOrientation = RAI", "CenterOfRotation = 0 0 0"})}}},
  };
  return cases;
}

class VolumeOf : public testing::TestWithParam<Case> {};

TEST_P(VolumeOf, IsTheSame) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : GetParam().files) {
    fs::create_directories((folder.Path() / name).parent_path());
    ASSERT_TRUE(host::WriteFile(folder.Path() / name, content).ok());
  }
  ImportPool pool({}, 1);
  const auto read = DecodeFile(folder.Path() / GetParam().files[0].first, Links::kFollow, pool);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const ImageHeader& header = read->header;
  ASSERT_EQ(header.width, 8u);
  ASSERT_EQ(header.height, 6u);
  ASSERT_EQ(header.depth, 4u);
  ASSERT_EQ(header.channels, 1u);
  ASSERT_NE(header.frame, FileFrame::kNotSaid);
  const bool is_nifti = header.kind == FileKind::kNifti;
  const std::array<double, 3> spacing = {0.5, 0.5, 2};
  const std::array<double, 3> origin = is_nifti ? std::array{-10.0, 20.0, 30.0} : std::array{1.0, 2.0, 3.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(header.spacing[axis], spacing[axis], 1e-6) << axis;
    EXPECT_NEAR(header.origin[axis], origin[axis], 1e-5) << axis;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = is_nifti && axis == 1 ? -1 : 1;  // its rows run to the front
      EXPECT_NEAR(header.direction[axis][k], axis == k ? along : 0, 1e-6) << axis << k;
    }
  }
  EXPECT_EQ(header.slope, 1);
  EXPECT_EQ(header.intercept, 0);
  for (std::size_t i = 0; i < 192; ++i) {
    const int x = static_cast<int>(i % 8), y = static_cast<int>(i / 8 % 6), z = static_cast<int>(i / 48);
    ASSERT_EQ(SampleAt(header, read->samples.Data(), i), Sample(x, y, z) + 0.0) << i;
  }
}

std::string NameOfCase(const testing::TestParamInfo<Case>& one) {
  return one.param.name;
}
INSTANTIATE_TEST_SUITE_P(Nifti, VolumeOf, testing::ValuesIn(NiftiCases()), NameOfCase);
INSTANTIATE_TEST_SUITE_P(Nrrd, VolumeOf, testing::ValuesIn(NrrdCases()), NameOfCase);
INSTANTIATE_TEST_SUITE_P(MetaImage, VolumeOf, testing::ValuesIn(MetaCases()), NameOfCase);

class OneVolume : public testing::Test {
 protected:
  base::Result<ImageSeries> Open(const char* name, const std::string& content,
                                 const ImageSeriesOptions& options = {}) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / name, content).ok());
    return ImageSeries::Open(folder_.Path() / name, options);
  }
  TemporaryFolder folder_;
};

TEST_F(OneVolume, SpacingsHaveUnitsToo) {
  const std::vector<std::string> lines = {"type: short",
                                          "dimension: 3",
                                          "sizes: 8 6 4",
                                          "encoding: raw",
                                          "endian: little",
                                          "spacings: 0.05 0.05 2000",
                                          "units: \"cm\" \"cm\" \"um\""};
  std::string file = "NRRD0004\n";
  for (const std::string& line : lines) file += line + "\n";
  ImageSeriesOptions options;
  const auto refused = Open("a.nrrd", file + "\n" + Samples(8, 6, 4));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("the files do not say how the patient lies; give --axes"));
  options.axes = {"left", "posterior", "superior"};
  const auto series = Open("a.nrrd", file + "\n" + Samples(8, 6, 4), options);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_NEAR(series->Info().pixel_mm, 0.5, 1e-9);
  EXPECT_NEAR(series->Info().slice_mm, 2.0, 1e-9);
}

TEST_F(OneVolume, ColoursMayComeFirstOrLast) {
  std::string first, last;
  const auto sample = [](int c, int i) { return static_cast<char>(50 * c + i); };
  for (int i = 0; i < 24; ++i) {
    for (int c = 0; c < 3; ++c) first += sample(c, i);
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < 24; ++i) last += sample(c, i);
  }
  const std::string common = "type: uchar\ndimension: 4\nspace: LPS\nencoding: raw\nspace origin: (0,0,0)\n";
  const std::string steps = "(1,0,0) (0,1,0) (0,0,1)";
  const auto before = Open("a.nrrd", "NRRD0004\n" + common + "sizes: 3 4 3 2\nspace directions: none " +
                                         steps + "\nkinds: RGB-color space space space\n\n" + first);
  const auto behind = Open("b.nrrd", "NRRD0004\n" + common + "sizes: 4 3 2 3\nspace directions: " + steps +
                                         " none\nkinds: space space space rgb\n\n" + last);
  ASSERT_TRUE(before.ok()) << before.error().Text();
  ASSERT_TRUE(behind.ok()) << behind.error().Text();
  EXPECT_TRUE(before->Info().is_color);
  const auto picture = before->ReadSlice(1, {});
  EXPECT_EQ(picture->samples, behind->ReadSlice(1, {})->samples);
  EXPECT_EQ(picture->At(2, 1)[2], 100 + 12 + 4 + 2);
}

// A matrix of four dimensions has 16 numbers: its third row is not the numbers 7 to 9.
TEST_F(OneVolume, FourDimensionsKeepTheirTilt) {
  const auto series = Open(
      "a.mha",
      MakeMetaImage({"NDims = 4", "DimSize = 8 6 4 1", "ElementSpacing = 0.5 0.5 2 1", "Offset = 0 0 0 0",
                     "TransformMatrix = 1 0 0 0 0 0.98 0.199 0 0 -0.199 0.98 0 0 0 0 1"}));
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_NEAR(series->Info().tilt_deg, std::atan2(0.199, 0.98) * 180 / M_PI, 0.01);
  EXPECT_NEAR(series->Info().slice_mm, 2.0, 1e-3);
}

// The samples of a pair may begin like anything, here like a DICOM file without its preamble.
TEST_F(OneVolume, IsFoundByTheNameOfItsSamples) {
  std::string samples = Samples(8, 6, 4);
  samples.replace(0, 2, std::string("\x08\0", 2));
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "a.hdr", NiftiHdr()).ok());
  const auto series = Open("a.img", samples);
  ASSERT_TRUE(series.ok()) << series.error().Text();
  EXPECT_EQ(series->Info().format, "NIfTI");
}

// Whatever the length, a file that ends too early is a refusal in words.
TEST(VolumesCutShort, AreRefusedAtEveryLength) {
  const TemporaryFolder folder;
  ImportPool pool({}, 1);
  const std::pair<const char*, std::string> files[] = {
      {"a.nii", MakeNifti()},
      {"a.nii.gz", Gzip(MakeNifti())},
      {"b.nii", Nifti2("n+2") + Samples(8, 6, 4)},
      {"a.nrrd", MakeNrrd()},
      {"b.nrrd", Nrrd({"encoding: gzip"}, Gzip(Samples(8, 6, 4)))},
      {"c.nrrd", Nrrd({"encoding: hex"}, HexOfSamples())},
      {"a.mha", MakeMetaImage()},
      {"b.mha", Meta({"CompressedData = True"}, Zlib(Samples(8, 6, 4)))},
      {"c.mha", Meta({"BinaryData = False"}, TextOfSamples(" "))},
      {"a.png", MakePng(8, 6, 6)},
  };
  for (const auto& [name, whole] : files) {
    const fs::path path = folder.Path() / name;
    ASSERT_TRUE(host::WriteFile(path, whole).ok());
    ASSERT_TRUE(DecodeFile(path, Links::kFollow, pool).ok()) << name;
    // what packs them ends with sums of what was packed, which readers may leave unread; text may lose its last digits
    const bool is_text = std::string_view(name) == "c.mha";
    const std::size_t last = whole.size() -
                             (std::string_view(name).ends_with(".gz") || name[0] == 'b' ? 12 : 0) -
                             (is_text ? 5 : 0);
    for (std::size_t length = 0; length < last; ++length) {
      ASSERT_TRUE(host::WriteFile(path, whole.substr(0, length)).ok());
      const auto read = DecodeFile(path, Links::kFollow, pool);
      ASSERT_FALSE(read.ok()) << name << " of " << length << " bytes";
      ASSERT_NE(read.error().code, base::ErrorCode::kImportCrashed) << name << " of " << length << " bytes";
      ASSERT_GT(read.error().message.size(), 40u);
    }
  }
}

}  // namespace
}  // namespace trocar::images
