// SPDX-License-Identifier: Apache-2.0
// What the readers of image files say when they refuse one: each message is provoked by a file of which it is true. A list made from
// the sources shows that none is left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "import_worker.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/image_series.h"
#include "trocar/images/image_stack.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using namespace test;
using testing::HasSubstr;

struct Case {
  std::string why;  ///< what the reader says, whole
  ErrorCode code;
  std::string file;
  std::string content;
  std::string data{};  ///< of a.raw or a.img beside it
};

template <typename Number>
std::string NiftiWith(std::size_t at, Number number) {
  std::string file = MakeNifti();
  Put(file, at, number);
  return file;
}

std::string NiftiOfFive(std::int16_t fourth, std::int16_t fifth) {
  std::string file = NiftiWith<std::int16_t>(40, 5);
  Put(file, 48, fourth), Put(file, 50, fifth);
  return file;
}

/// With a qform that is no rotation; with the sform or without.
std::string NiftiWithBadQform(std::int16_t sform) {
  std::string file = MakeNifti();
  Put<std::int16_t>(file, 252, 1), Put<std::int16_t>(file, 254, sform);
  Put<float>(file, 256, 1), Put<float>(file, 260, 1);
  Put<float>(file, 280, 0);
  return file;
}

std::string NiftiHdr(float begin) {
  std::string file = NiftiWith<float>(108, begin).substr(0, 352);
  return file.replace(344, 4, std::string("ni1\0", 4));
}

std::vector<Case> NiftiCases() {
  const auto invalid = ErrorCode::kImageGeometryInvalid, bad = ErrorCode::kImageUndecodable,
             unread = ErrorCode::kImageUnsupported, cut = ErrorCode::kImageTruncated,
             large = ErrorCode::kImageTooLarge;
  std::string no_mark = MakeNifti(), wrong_size = NiftiWith<std::int32_t>(0, 7);
  no_mark.replace(344, 4, 4, '\0');
  std::string many_more(544, '\0');
  Put<std::int32_t>(many_more, 0, 540);
  many_more.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
  for (std::size_t i = 0; i < 8; ++i)
    Put<std::int64_t>(many_more, 16 + 8 * i, i == 0 ? 5 : i < 4 ? 4 : std::int64_t{1} << 40);
  std::string nan_spacing = NiftiWith<std::int16_t>(254, 0);
  Put(nan_spacing, 80, std::nanf(""));
  std::string nan_intercept = NiftiWith(116, std::nanf(""));
  Put<float>(nan_intercept, 112, 1);
  std::string in_metres = NiftiWith<char>(123, 1);
  return {
      {"it begins like NIfTI and ends within its header", bad, "a.nii", MakeNifti().substr(0, 200)},
      {"it ends within its header", cut, "a.nii", many_more.substr(0, 400)},
      {"its header has no NIfTI mark, as those of ANALYZE 7.5, which leave open which side is left", invalid,
       "a.hdr", no_mark},
      {"the size of its NIfTI header is wrong", bad, "a.nii", wrong_size},
      {"what gzip has packed in it is no NIfTI file", bad, "a.nii.gz", Gzip("a letter home")},
      {"it is no DICOM, NIfTI, NRRD, MetaImage, PNG, JPEG or TIFF file", bad, "a.nii", "a letter home"},
      {"its number of dimensions is not between 1 and 7", bad, "a.nii", NiftiWith<std::int16_t>(40, 200)},
      {"one of its sides has no voxel or a negative number", bad, "a.nii", NiftiWith<std::int16_t>(42, -8)},
      {"one of its sides is longer than 16384 voxels", large, "a.nii", NiftiWith<std::int16_t>(42, 32767)},
      {"it holds 5 volumes; extract one of them", unread, "a.nii", NiftiOfFive(5, 1)},
      {"it has 3 values a voxel; extract one of them", unread, "a.nii", NiftiOfFive(1, 3)},
      {"it holds more volumes than can be counted", large, "a.nii", many_more},
      {"its voxel type 32 (complex numbers) is not read", unread, "a.nii", NiftiWith<std::int16_t>(70, 32)},
      {"its voxel type 2304 (colour with transparency) is not read", unread, "a.nii",
       NiftiWith<std::int16_t>(70, 2304)},
      {"its voxel type 1536 (floating point of 128 bits) is not read", unread, "a.nii",
       NiftiWith<std::int16_t>(70, 1536)},
      {"its voxel type 1 (single bits) is not read", unread, "a.nii", NiftiWith<std::int16_t>(70, 1)},
      {"its voxel type 0 (not said) is not read", unread, "a.nii", NiftiWith<std::int16_t>(70, 0)},
      {"its voxel type 99 is not read", unread, "a.nii", NiftiWith<std::int16_t>(70, 99)},
      {"its unit of length has the code 5, which NIfTI does not know (1 to 3)", invalid, "a.nii",
       NiftiWith<char>(123, 5)},
      {"its sform has an axis without length", invalid, "a.nii", NiftiWith<float>(280, 0)},
      {"its sform has an axis that is not a finite number", invalid, "a.nii", NiftiWith(284, std::nanf(""))},
      {"its qform is no rotation", invalid, "a.nii", NiftiWithBadQform(0)},
      {"its sform has an axis without length, and its qform is no rotation", invalid, "a.nii",
       NiftiWithBadQform(1)},
      {"a pixel or slice distance in its header is not a finite number", invalid, "a.nii", nan_spacing},
      {"a pixel or slice distance in its header is 500 mm, not between 0.001 and 200 mm", invalid, "a.nii",
       in_metres},
      {"its position or orientation is not a finite number", invalid, "a.nii", NiftiWith(292, HUGE_VALF)},
      {"the scale of its grey values is not a finite number", invalid, "a.nii", nan_intercept},
      {"where its voxels begin (vox_offset) is no place behind its header", bad, "a.nii",
       NiftiWith<float>(108, 16)},
      {"it does not say where its voxels begin (vox_offset), nor does its length tell", bad, "a.nii",
       NiftiWith<float>(108, 0) + "more"},
      {"where its voxels begin (vox_offset) is no place in a file", bad, "a.hdr", NiftiHdr(-1)},
      {"its header announces 384 bytes of samples, which the 100 bytes there cannot hold", cut, "a.nii",
       MakeNifti().substr(0, 452)},
      {"its header announces 384 bytes of samples, which the 5 bytes there cannot hold", cut, "a.hdr",
       NiftiHdr(0), "short"},
      {"it ends before its last sample", cut, "a.nii.gz", Gzip(MakeNifti().substr(0, 452))},
      {"its samples do not unpack as gzip or zlib", bad, "a.nii.gz",
       Gzip(MakeNifti()).substr(0, 60) + std::string(500, 'x')},
  };
}

std::string Nrrd(const std::vector<std::string>& lines, const std::string& samples = Samples(8, 6, 4)) {
  return MakeNrrd(lines, false) + "\n" + samples;
}

std::string Without(std::string text, const std::string& line) {
  const auto at = text.find(line);
  return text.erase(at, text.find('\n', at) + 1 - at);
}

std::vector<Case> NrrdCases() {
  const auto invalid = ErrorCode::kImageGeometryInvalid, bad = ErrorCode::kImageUndecodable,
             unread = ErrorCode::kImageUnsupported, cut = ErrorCode::kImageTruncated,
             large = ErrorCode::kImageTooLarge, unsafe = ErrorCode::kImagePathUnsafe;
  const auto four = [](const char* sizes, const char* kinds, const char* directions) {
    return std::vector<std::string>{"dimension: 4", "sizes: " + std::string(sizes),
                                    "kinds: " + std::string(kinds),
                                    "space directions: " + std::string(directions)};
  };
  const char* const three = "(.5,0,0) (0,.5,0) (0,0,2)";
  const std::string steps = three;
  auto segments = four("2 8 6 4", "list domain domain domain", ("none " + steps).c_str());
  auto nowhere = segments, unlabelled = segments;
  nowhere.insert(nowhere.end(), {"Segment0_ID:=a", "Segment0_LabelValue:=1", "Segment0_Layer:=2"});
  unlabelled.insert(unlabelled.end(), {"Segment0_ID:=a", "Segment1_ID:=b", "Segment2_ID:=c"});
  const std::string detached = "data file: a.raw";
  return {
      {"its first line is no mark of a NRRD file", bad, "a.nrrd", "NRRD00x4" + MakeNrrd().substr(8)},
      {"its version of NRRD is newer than 5", unread, "a.nrrd", "NRRD0006" + MakeNrrd().substr(8)},
      {"its header lacks encoding", bad, "a.nrrd", Without(Nrrd({}), "encoding")},
      {"a line of its header is neither field nor comment", bad, "a.nrrd", Nrrd({"sizes 8 6 4"})},
      {"its header has the field \"space units\" twice", bad, "a.nrrd",
       "NRRD0004\nspaceunits: \"mm\" \"mm\" \"mm\"\n" +
           Nrrd({"space units: \"cm\" \"cm\" \"cm\""}).substr(9)},
      {"its header is longer than 1024 KiB", unread, "a.nrrd",
       "NRRD0004\n#" + std::string(2 << 20, 'x') + "\n" + MakeNrrd().substr(9)},
      {"its header neither ends with an empty line nor names a data file", cut, "a.nrrd",
       MakeNrrd({}, false)},
      {"its type \"block\" is not read", unread, "a.nrrd", Nrrd({"type: block"})},
      {"its type \"char\" is not read", unread, "a.nrrd", Nrrd({"type: char"})},
      {"its type \"?\" is not read", unread, "a.nrrd", Nrrd({"type: <b>Doe, Jane</b>"})},
      {"its encoding \"bzip2\" is not read; save it as raw or gzip", unread, "a.nrrd",
       Nrrd({"encoding: bzip2"})},
      {"its encoding \"zrl\" is not read; save it as raw or gzip", unread, "a.nrrd", Nrrd({"encoding: zrl"})},
      {"its header lacks endian, which samples of several bytes need", bad, "a.nrrd",
       Without(Nrrd({}), "endian")},
      {"endian of its header is neither little nor big", bad, "a.nrrd", Nrrd({"endian: middle"})},
      {"its dimension is not between 1 and 16", bad, "a.nrrd", Nrrd({"dimension: 17"})},
      {"dimension in its header is no whole number", bad, "a.nrrd", Nrrd({"dimension: three"})},
      {"sizes in its header is too large a number", large, "a.nrrd",
       Nrrd({"sizes: 8 9223372036854775808 4"})},
      {"dimension and sizes of its header do not agree", bad, "a.nrrd", Nrrd({"sizes: 8 6"})},
      {"one of its sizes is 0 or negative", bad, "a.nrrd", Nrrd({"sizes: 8 0 4"})},
      {"dimension and kinds of its header do not agree", bad, "a.nrrd", Nrrd({"kinds: domain domain"})},
      {"its space directions are not one for each of its axes", bad, "a.nrrd",
       Nrrd({"space directions: (1,0,0) (0,1,0)"})},
      {"its space directions differ in how many numbers they have", bad, "a.nrrd",
       Nrrd({"space directions: (1,0,0) (0,1) (0,0,1)"})},
      {"space directions in its header is no vector in brackets", bad, "a.nrrd",
       Nrrd({"space directions: 1 0 0 0 1 0 0 0 1"})},
      {"space directions in its header is no number", bad, "a.nrrd",
       Nrrd({"space directions: (a,0,0) (0,1,0) (0,0,1)"})},
      {"its space has neither two nor three dimensions", unread, "a.nrrd",
       Nrrd({"space directions: (1) (1) (1)"})},
      {"one of its space directions leads through time as well", invalid, "a.nrrd",
       Nrrd({"space directions: (1,0,0,0) (0,1,0,0) (0,0,1,1)", "space origin: (0,0,0,0)"})},
      {"one of its space directions has no length", invalid, "a.nrrd",
       Nrrd({"space directions: (1,0,0) (0,0,0) (0,0,1)"})},
      {"its space origin is no place in its space", bad, "a.nrrd", Nrrd({"space origin: (1,2)"})},
      {"its space is left-anterior-superior, which programs read in two ways; save it as LPS or RAS", invalid,
       "a.nrrd", Nrrd({"space: LAS"})},
      {"its unit of length \"furlong\" is none of mm, cm, dm, m, um, nm and inch", invalid, "a.nrrd",
       Nrrd({"space units: \"mm\" \"furlong\" \"mm\""})},
      {"its unit of length \"pixel\" is none of mm, cm, dm, m, um, nm and inch", invalid, "a.nrrd",
       Nrrd({"units: \"pixel\" \"pixel\" \"pixel\""})},
      {"the number of \"space units\" in its header is 1, not 3", bad, "a.nrrd",
       Nrrd({"space units: \"mm\""})},
      {"\"units\" and \"space units\" of its header do not agree", bad, "a.nrrd",
       Nrrd({"units: \"cm\" \"cm\" \"cm\"", "space units: \"mm\" \"mm\" \"mm\""})},
      {"\"units\" of its header differ from axis to axis", bad, "a.nrrd",
       Nrrd({"units: \"cm\" \"mm\" \"mm\""})},
      {"dimension and spacings of its header do not agree", bad, "a.nrrd",
       Without(Nrrd({"spacings: 1 1"}), "space directions")},
      {"several of its axes are no directions in space", unread, "a.nrrd",
       Nrrd(four("2 8 6 3", "list domain domain list", "none (1,0,0) (0,1,0) none"))},
      {"fewer than two of its axes are directions in space", unread, "a.nrrd",
       Nrrd({"dimension: 1", "sizes: 192", "space directions: (1,0,0)"})},
      {"it holds 4 volumes; extract one of them", unread, "a.nrrd",
       Nrrd(four("8 6 1 4", "domain domain domain time", (steps + " none").c_str()))},
      {"it has 2 values a voxel, which are neither colours of 8 bits nor layers of segments", unread,
       "a.nrrd", Nrrd(four("2 8 6 2", "complex domain domain domain", ("none " + steps).c_str()))},
      {"its header announces more samples than any computer can hold", large, "a.nrrd",
       Nrrd(four("4611686018427387904 8 6 2", "space space space list", (steps + " none").c_str()))},
      {"it has 65 layers, more than 64", large, "a.nrrd",
       Nrrd(four("65 8 6 4", "list domain domain domain", ("none " + steps).c_str()))},
      {"one of its segments lies in layer 2, and it has 2", bad, "a.nrrd", Nrrd(nowhere)},
      {"it names segments without saying which label of which layer they are", bad, "a.nrrd",
       Nrrd(unlabelled)},
      {"it names a data file outside its own folder", unsafe, "a.nhdr",
       MakeNrrd({"data file: b/../../a.raw"}, false)},
      {"it names its data file by a path from the root on", unsafe, "a.nhdr",
       MakeNrrd({"data file: /etc/passwd"}, false)},
      {"the path of its data file has a backslash; write it with /", unsafe, "a.nhdr",
       MakeNrrd({"data file: data\\a.raw"}, false)},
      {"the name of its data file has a zero byte in it", unsafe, "a.nhdr",
       MakeNrrd({"data file: a" + std::string(1, '\0') + ".raw"}, false)},
      {"the path of its data file is longer than 255 bytes", unsafe, "a.nhdr",
       MakeNrrd({"data file: " + std::string(256, 'a')}, false)},
      {"it does not name its data file", unsafe, "a.nhdr", MakeNrrd({"data file: ./"}, false)},
      {"its samples are in several files", unread, "a.nhdr",
       MakeNrrd({"data file: LIST 2"}, false) + "a.raw\nb.raw\n"},
      {"its samples are in several files", unread, "a.nhdr", MakeNrrd({"data file: a%03d.raw 1 4 1"}, false)},
      {"it ends before the list of its data files", cut, "a.nhdr", MakeNrrd({"data file: LIST"}, false)},
      {"\"line skip\" of its header is negative", bad, "a.nhdr", MakeNrrd({"line skip: -1", detached}, false),
       "data"},
      {"it has fewer lines than its \"line skip\" leaves out", cut, "a.nhdr",
       MakeNrrd({"line skip: 3", detached}, false), "one\ntwo"},
      {"its header announces 384 bytes of samples, which the 0 bytes there cannot hold", cut, "a.nrrd",
       Nrrd({"byte skip: 9223372036854775807"})},
      {"its \"byte skip\" counts from the end of the file on, where its samples are text", unread, "a.nrrd",
       Nrrd({"byte skip: -1", "encoding: text"})},
      {"its \"byte skip\" counts back from the end of the file, which is too short for its samples", cut,
       "a.nhdr", MakeNrrd({"byte skip: -5", detached}, false), Samples(8, 6, 4)},
      {"its samples are no hexadecimal digits", bad, "a.nrrd",
       Nrrd({"encoding: hex"}, std::string(800, 'x'))},
      {"one of the samples in its text is no number", bad, "a.nrrd",
       Nrrd({"encoding: text"}, "1 2 x " + std::string(500, ' '))},
      {"one of the samples in its text is beyond its type", bad, "a.nrrd",
       Nrrd({"encoding: text"}, "1 2 40000 " + std::string(500, ' '))},
      {"it ends before its last sample", cut, "a.nrrd",
       Nrrd({"encoding: text"}, std::string(500, ' ') + "1")},
      {"it unpacks to 1464 MiB, more than the 1024 MiB allowed", large, "a.nrrd",
       Nrrd({"sizes: 16000 16000 3"})},
  };
}

std::string Meta(const std::vector<std::string>& lines, const std::string& samples) {
  const std::string file = MakeMetaImage(lines), local = "LOCAL\n";
  return file.substr(0, file.find(local) + local.size()) + samples;
}

std::vector<Case> MetaCases() {
  const auto invalid = ErrorCode::kImageGeometryInvalid, bad = ErrorCode::kImageUndecodable,
             unread = ErrorCode::kImageUnsupported, cut = ErrorCode::kImageTruncated;
  const std::string plain = MakeMetaImage();
  return {
      {"its header lacks DimSize", bad, "a.mha", Without(plain, "DimSize")},
      {"its header has the field \"NDims\" twice", bad, "a.mha", "NDims = 2\n" + plain},
      {"a line of its header is no field", bad, "a.mha", "NDims = 3\na letter home\n" + plain},
      {"its header is longer than 1024 KiB", unread, "a.mha",
       "NDims = 3\nComment = " + std::string(2 << 20, 'x') + "\n"},
      {"its header ends before the field ElementDataFile", cut, "a.mha", "ObjectType = Image\nNDims = 3\n"},
      {"its NDims is not between 2 and 10", unread, "a.mha", MakeMetaImage({"NDims = 11"})},
      {"NDims and DimSize of its header do not agree", bad, "a.mha", MakeMetaImage({"DimSize = 8 6"})},
      {"its ElementType \"MET_STRING\" is not read", unread, "a.mha",
       MakeMetaImage({"ElementType = MET_STRING"})},
      {"it has 2 values a voxel; one, or three of 8 bits as colours, are read", unread, "a.mha",
       MakeMetaImage({"ElementNumberOfChannels = 2"})},
      {"its ElementToIntensityFunction is applied by some programs and not by others", invalid, "a.mha",
       MakeMetaImage({"ElementToIntensityFunctionSlope = 2"})},
      {"its ElementToIntensityFunction is applied by some programs and not by others", invalid, "a.mha",
       MakeMetaImage({"ElementToIntensityFunctionOffset = -1024"})},
      {"Offset has too few numbers", bad, "a.mha", MakeMetaImage({"Offset = 1 2"})},
      {"Offset and Position of its header do not agree", bad, "a.mha", MakeMetaImage({"Position = 4 5 6"})},
      {"ElementSpacing of its header is not greater than 0", invalid, "a.mha",
       MakeMetaImage({"ElementSpacing = 0.5 0 2"})},
      {"the matrix of its directions has 16 numbers where 9 belong", bad, "a.mha",
       MakeMetaImage({"TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"})},
      {"TransformMatrix has too few numbers", bad, "a.mha",
       MakeMetaImage({"NDims = 4", "DimSize = 8 6 4 1", "ElementSpacing = 0.5 0.5 2 1", "Offset = 1 2 3 0"})},
      {"one of its directions leads out of the body's space", invalid, "a.mha",
       MakeMetaImage({"NDims = 4", "DimSize = 8 6 4 1", "ElementSpacing = 0.5 0.5 2 1", "Offset = 1 2 3 0",
                      "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 0.9 0.4 0 0 0 1"})},
      {"one of its directions has no length", invalid, "a.mha",
       MakeMetaImage({"TransformMatrix = 1 0 0 0 0 0 0 0 1"})},
      {"its unit of length \"parsec\" is none of mm, cm, dm, m, um, nm and inch", invalid, "a.mha",
       MakeMetaImage({"DistanceUnits = parsec"})},
      {"it holds 2 volumes; extract one of them", unread, "a.mha",
       MakeMetaImage({"NDims = 4", "DimSize = 8 6 2 2", "ElementSpacing = 0.5 0.5 2 1", "Offset = 1 2 3 0",
                      "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"})},
      {"its samples are in several files", unread, "a.mhd", MakeMetaImage({}, "LIST") + "a.raw\nb.raw\n"},
      {"its samples are in several files", unread, "a.mhd", MakeMetaImage({}, "a%03d.raw 1 4 1")},
      {"it ends before the list of its data files", cut, "a.mhd", MakeMetaImage({}, "LIST")},
      {"HeaderSize of its header is less than -1", bad, "a.mha", MakeMetaImage({"HeaderSize = -2"})},
      {"its samples are to be found from the end of the file on (HeaderSize -1) and are packed or text",
       unread, "a.mha", Meta({"HeaderSize = -1", "CompressedData = True"}, Zlib(Samples(8, 6, 4)))},
      {"its samples do not unpack as gzip or zlib", bad, "a.mha", MakeMetaImage({"CompressedData = True"})},
  };
}

/// One page of TIFF, uncompressed, with samples of any kind; `format` as in the tag SampleFormat.
std::string Tiff(std::uint16_t bits, std::uint16_t channels, std::uint16_t format) {
  const std::string pixels(std::size_t{4} * 4 * channels * bits / 8, '\1');
  std::string file("II*\0", 4);
  file += Bytes(static_cast<std::uint32_t>(8 + pixels.size())) + pixels;
  constexpr std::uint16_t kEntries = 10;
  const auto entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
    file += Bytes(tag) + Bytes(type) + Bytes<std::uint32_t>(1) + Bytes(value);
  };
  file += Bytes(kEntries);
  entry(256, 4, 4), entry(257, 4, 4), entry(258, 3, bits), entry(259, 3, 1),
      entry(262, 3, channels >= 3 ? 2 : 1);
  entry(273, 4, 8), entry(277, 3, channels), entry(278, 4, 4);
  entry(279, 4, static_cast<std::uint32_t>(pixels.size())), entry(339, 3, format);
  return file + Bytes<std::uint32_t>(0);
}

std::vector<Case> PictureCases() {
  const auto bad = ErrorCode::kImageUndecodable, unread = ErrorCode::kImageUnsupported,
             cut = ErrorCode::kImageTruncated, large = ErrorCode::kImageTooLarge;
  std::string no_width = MakePng(8, 6, 6), png = MakePng(8, 6, 6);
  Put<std::uint32_t>(no_width, 16, 0);
  return {
      {"its end is missing", cut, "a.png", png.substr(0, png.size() - 5)},
      {"its PNG header is damaged", bad, "a.png", no_width},
      {"it is too small for the size in its header", cut, "a.png", MakePng(4000, 4000, 0)},
      {"it measures more than 16384 pixels a side", large, "a.png", MakePng(65535, 10, 0)},
      {"its decoder refuses it as damaged or of an unknown kind", bad, "a.tif",
       std::string("II*\0\xff\xff\xff\x7f", 8)},
      {"its samples are neither integers of 8 or 16 bits nor floating point of 32 bits", unread, "a.tif",
       Tiff(32, 1, 1)},
      {"its colours have neither 8 nor 16 bits", unread, "a.tif", Tiff(32, 3, 3)},
      {"it has 5 channels; grey or colour, also with transparency, is read", unread, "a.tif", Tiff(8, 5, 1)},
  };
}

std::vector<Case> AllCases() {
  std::vector<Case> cases;
  for (const auto& make : {NiftiCases, NrrdCases, MetaCases, PictureCases}) {
    const std::vector<Case> some = make();
    cases.insert(cases.end(), some.begin(), some.end());
  }
  return cases;
}

/// The pieces of text that `begin` puts together up to the bracket that closes it, as a pattern: "its side {1} is too long" matches
/// whatever stands for {1}.
std::string PatternAt(const std::string& source, std::size_t begin) {
  std::string pattern;
  bool is_joined = true;  // to the piece before: literals side by side
  int depth = 1;
  for (std::size_t i = begin; i < source.size() && depth > 0; ++i) {
    const char c = source[i];
    if (c == '{' || c == '(') ++depth;
    if (c == '}' || c == ')') --depth;
    if (c == '\'') {
      i += source[i + 1] == '\\' ? 3 : 2;
      is_joined = false;
    } else if (c == '"') {
      if (!is_joined && !pattern.ends_with(".*")) pattern += ".*";
      for (++i; source[i] != '"'; ++i) {
        if (source[i] == '\\') ++i;
        if (std::string("().*+?[]{}|^$").find(source[i]) != std::string::npos) pattern += '\\';
        pattern += source[i];
      }
      is_joined = true;
    } else if (c == '+' || std::isalnum(static_cast<unsigned char>(c)) != 0) {
      is_joined = false;
    }
  }
  return is_joined ? pattern : pattern + ".*";
}

/// Every text of a Failure{code, text} in the readers' sources but DICOM's, which have tests of their own.
std::set<std::string> PatternsOfSources() {
  std::set<std::string> patterns;
  for (const auto& entry : fs::directory_iterator(TROCAR_READER_SOURCES)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".cpp") || name.find("dicom") != std::string::npos) continue;
    const std::string source = *host::ReadFile(entry.path());
    const std::string maker = "Failure{ErrorCode::";
    for (auto at = source.find(maker); at != std::string::npos; at = source.find(maker, at + 1)) {
      const auto comma = source.find(',', at);
      patterns.insert(PatternAt(source, comma + 1));
    }
  }
  return patterns;
}

// Guards behind other checks; no file reaches them.
const std::set<std::string> kUnreachable = {
    "its header announces no pixels",
    "its pictures measure more than .* pixels a side",
    "the memory for its samples is too small",
    "it is no regular file",
    "it is no longer a DICOM file",
};

TEST(ReaderMessages, AreTrueOfTheFileAndEachIsProvoked) {
  std::set<std::string> unprovoked = PatternsOfSources();
  ASSERT_GT(unprovoked.size(), 90u) << "the sources were not found";
  ImportLimits limits;
  limits.most_bytes = std::uint64_t{1} << 30;
  ImportPool pool(limits, 1);
  for (const Case& c : AllCases()) {
    const TemporaryFolder folder;
    const fs::path path = folder.Path() / c.file;
    ASSERT_TRUE(host::WriteFile(path, c.content).ok());
    if (!c.data.empty()) {
      ASSERT_TRUE(host::WriteFile(folder.Path() / (c.file == "a.hdr" ? "a.img" : "a.raw"), c.data).ok());
    }
    const auto read = DecodeFile(path, Links::kFollow, pool);
    if (read.ok()) {
      ADD_FAILURE() << "it was read; expected: " << c.why;
      continue;
    }
    EXPECT_THAT(read.error().message, HasSubstr(": " + c.why + ";"));
    EXPECT_EQ(base::CodeText(read.error().code), base::CodeText(c.code)) << c.why;
    std::erase_if(unprovoked,
                  [&](const std::string& pattern) { return std::regex_match(c.why, std::regex(pattern)); });
  }
  for (const std::string& pattern : unprovoked) EXPECT_TRUE(kUnreachable.contains(pattern)) << pattern;
}

TEST(ReaderMessages, SayWhatPicturesDoNotSay) {
  const TemporaryFolder folder;
  const fs::path picture = folder.Path() / "a.tif", map = folder.Path() / "a.nrrd";
  ASSERT_TRUE(host::WriteFile(picture, MakeTiff(6, 5, 2)).ok());
  const auto series = ImageSeries::Open(picture);
  ASSERT_FALSE(series.ok());
  EXPECT_THAT(
      series.error().message,
      HasSubstr("do not say how large the patient is and how it lies (a resolution in them is for printers"));
  // a map says which of the two is missing
  ASSERT_TRUE(host::WriteFile(map, Nrrd({"space: scanner-xyz"})).ok());
  EXPECT_THAT(ReadLabelVolume(map).error().message, HasSubstr("does not say how it lies in the body"));
  ASSERT_TRUE(host::WriteFile(map, Without(Nrrd({}), "space directions")).ok());
  EXPECT_THAT(ReadLabelVolume(map).error().message, HasSubstr("does not say how large its voxels are"));
}

TEST(ReaderMessages, NameWhatAPairLacks) {
  const TemporaryFolder folder;
  ImportPool pool({}, 1);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "a.hdr", NiftiHdr(0)).ok());
  const auto read = DecodeFile(folder.Path() / "a.hdr", Links::kFollow, pool);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kFileMissing);
  EXPECT_THAT(read.error().message, HasSubstr("a file of the same name that ends in .img"));
}

// A part of the path may be a link that leads elsewhere.
TEST(ReaderMessages, RefuseLinksOnTheWayToTheData) {
  const TemporaryFolder folder;
  ImportPool pool({}, 1);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "a.nhdr", MakeNrrd({"data file: data/passwd"}, false)).ok());
  fs::create_symlink("/etc", folder.Path() / "data");
  const auto read = DecodeFile(folder.Path() / "a.nhdr", Links::kFollow, pool);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kImagePathUnsafe);
  EXPECT_THAT(read.error().message, HasSubstr("data is a symbolic link"));
}

}  // namespace
}  // namespace trocar::images
