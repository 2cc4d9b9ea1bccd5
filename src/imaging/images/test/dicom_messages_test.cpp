// SPDX-License-Identifier: Apache-2.0
// Each message of the DICOM readers is provoked by a file of which it is true. A new message of their sources joins by itself: the
// last test fails until the list has a file for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "import_worker.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using namespace test;
using testing::HasSubstr;

struct Provoked {
  const char* name;
  ErrorCode code;
  const char* says;  ///< what must be said
  std::function<std::string()>
      make;  ///< the file; empty for what no file brings about, because the other checks come before
};

std::function<std::string()> With(const std::function<void(DicomFields&)>& change) {
  return [=] {
    DicomFields fields;
    change(fields);
    return MakeDicom(fields);
  };
}
std::function<std::string()> WithSyntax(const char* last) {
  return With([=](DicomFields& f) { f.transfer_syntax = std::string("1.2.840.10008.1.2") + last; });
}
std::function<std::string()> WithClass(const char* last) {
  return With([=](DicomFields& f) { f.sop_class = std::string("1.2.840.10008.5.1.4.1.1.") + last; });
}
std::string Sides(std::uint16_t rows, std::uint16_t columns) {
  return Element(0x28, 0x10, "US", Bytes(rows)) + Element(0x28, 0x11, "US", Bytes(columns));
}
std::function<std::string()> WithFrames(const char* frames) {
  return With([=](DicomFields& f) { f.dimensions = Element(0x28, 8, "IS", frames) + Sides(6, 8); });
}
std::string PaletteTables(std::uint16_t entries, std::uint16_t bits, std::size_t bytes) {
  std::string text;
  for (std::uint16_t c = 0; c < 3; ++c)
    text += Element(0x28, static_cast<std::uint16_t>(0x1101 + c), "US",
                    Bytes(entries) + Bytes<std::uint16_t>(0) + Bytes(bits));
  for (std::uint16_t c = 0; c < 3; ++c)
    text += Element(0x28, static_cast<std::uint16_t>(0x1201 + c), "OW", std::string(bytes, '\1'));
  return text;
}
std::function<std::string()> WithPalette(const std::string& tables) {
  return With([=](DicomFields& f) {
    f.shown = "PALETTE COLOR", f.allocated = f.stored = 8, f.high = 7, f.is_signed = 0;
    f.palette = tables, f.pixels = std::string(48, '\0');
  });
}
std::string Deflated(const std::function<std::string(std::string)>& damage) {
  DicomFields fields;
  fields.transfer_syntax = "1.2.840.10008.1.2.1.99";
  const std::string file = MakeDicom(fields);
  const std::size_t elements = file.find(std::string("\x08\0\x16\0UI", 6));
  const std::string packed = Zlib(file.substr(elements));
  return file.substr(0, elements) + damage(packed.substr(2, packed.size() - 6));
}
std::string Open(std::uint16_t element, const char* type) {
  return Bytes<std::uint16_t>(0x40) + Bytes(element) + type + std::string(2, '\0') +
         Bytes<std::uint32_t>(0xFFFFFFFF);
}
std::string Item(std::uint16_t element, std::uint32_t length) {
  return Bytes<std::uint16_t>(0xFFFE) + Bytes(element) + Bytes(length);
}
std::function<std::string()> WithMore(const std::string& more) {
  return With([=](DicomFields& f) { f.more = more; });
}

std::vector<Provoked> MakeProvoked() {
  const auto truncated = ErrorCode::kImageTruncated;
  const auto undecodable = ErrorCode::kImageUndecodable;
  const auto unsupported = ErrorCode::kImageUnsupported;
  const auto missing = ErrorCode::kImageSliceMissing;
  const auto geometry = ErrorCode::kImageGeometryInvalid;
  const auto large = ErrorCode::kImageTooLarge;
  std::string nested;
  for (int i = 0; i < 100; ++i) nested += Open(0x275, "SQ") + Item(0xE000, 0xFFFFFFFF);
  return {
      // dicom_structure.cpp
      {"OnlyThePreamble", truncated, "it ends before the first element of its image",
       [] { return MakeDicom({}).substr(0, 132); }},
      {"CutInAnElement", truncated, "it ends within an element",
       [] { return MakeDicom({}).substr(0, 132) + Element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + "\x08"; }},
      {"ElementTooLong", truncated, "one of its elements is longer than what holds it",
       [] {
         const std::string file = MakeDicom({});
         return file.substr(0, file.find(std::string("\x20\0\x32\0DS", 6)) + 11);
       }},
      {"SequenceCut", truncated, "it ends within a sequence",
       [] {
         return MakeDicom({}).substr(0, 132) + Element(2, 0x10, "UI", "1.2.840.10008.1.2.1") +
                Open(0x275, "SQ");
       }},
      {"NestedTooDeep", undecodable, "its sequences are nested too deep", WithMore(nested)},
      {"SequenceEndsTwice", undecodable, "its sequences end where they did not begin",
       WithMore(Item(0xE0DD, 0))},
      {"ItemAlone", undecodable, "it has an item outside any sequence", WithMore(Item(0xE000, 0))},
      {"SequenceOfElements", undecodable, "it has a sequence of something else than items",
       WithMore(Open(0x275, "SQ") + Element(8, 5, "CS", "x"))},
      {"DeflatedCut", truncated, "its deflated elements end too early",
       [] {
         return Deflated([](const std::string& packed) { return packed.substr(0, packed.size() / 2); });
       }},
      {"DeflatedDamaged", undecodable, "its deflated elements are damaged",
       [] { return Deflated([](const std::string&) { return std::string(300, '\xff'); }); }},
      {"DeflatedBomb", large, "its deflated elements unpack to more than the 65 MiB allowed",
       [] {
         return Deflated([](const std::string&) {
           const std::string packed = Zlib(std::string(80u << 20, '\0'));
           return packed.substr(2, packed.size() - 6);
         });
       }},
      {"MislabelledAndLarge", large, "it is larger than is allowed",
       [] {
         DicomFields fields;
         fields.transfer_syntax = "1.2.840.10008.1.2";
         fields.pixels = std::string(80u << 20, '\0');
         return MakeDicom(fields);
       }},
      // dicom_content.cpp: other files than images
      {"Segmentation", missing, "it is a DICOM segmentation (SEG) and holds no slices", WithClass("66.4")},
      {"Structures", missing, "it is a DICOM set of structures (RTSTRUCT)", WithClass("481.3")},
      {"Dose", missing, "it is a DICOM dose of radiotherapy (RTDOSE)", WithClass("481.2")},
      {"Plan", missing, "it is a DICOM plan or record of radiotherapy", WithClass("481.5")},
      {"Report", missing, "it is a DICOM report (SR)", WithClass("88.22")},
      {"KeyObjects", missing, "it is a DICOM selection of key objects (KO)", WithClass("88.59")},
      {"Presentation", missing, "it is a DICOM presentation state (PR)", WithClass("11.1")},
      {"Directory", missing, "it is a DICOM list of contents (DICOMDIR)",
       With([](DicomFields& f) { f.sop_class = "1.2.840.10008.1.3.10"; })},
      {"Document", missing, "it is a document in DICOM", WithClass("104.1")},
      {"RawData", missing, "it is DICOM raw data", WithClass("66")},
      {"Registration", missing, "it is a DICOM registration", WithClass("66.1")},
      {"Waveform", missing, "it is a DICOM waveform", WithClass("9.1.1")},
      {"ParametricMap", missing, "it is a DICOM parametric map", WithClass("30")},
      {"Surface", missing, "it is a DICOM surface", WithClass("66.5")},
      {"WithoutAPicture", missing, "it is a DICOM file without a picture", WithClass("67")},
      // and pixels that are packed otherwise
      {"MakersSyntax", unsupported, "its transfer syntax is a maker's own, which is not read",
       With([](DicomFields& f) { f.transfer_syntax = "1.3.46.670589.33.1.4.1"; })},
      {"UnknownSyntax", unsupported, "its transfer syntax is not known", WithSyntax(".4.999")},
      {"Encapsulated", unsupported, "its pixels are encapsulated without being packed, which is not read",
       WithSyntax(".1.98")},
      {"Smpte", unsupported, "its pixels are a video (SMPTE ST 2110), which is not read", WithSyntax(".7.1")},
      {"Jpeg2000Part2", unsupported, "its pixels are packed as JPEG 2000 part 2, which is not read",
       WithSyntax(".4.92")},
      {"Jpip", unsupported, "its pixels lie on a server (JPIP), which is not asked", WithSyntax(".4.94")},
      {"Mpeg", unsupported, "its pixels are a video (MPEG), which is not read", WithSyntax(".4.100")},
      {"Hevc", unsupported, "its pixels are a video (HEVC), which is not read", WithSyntax(".4.107")},
      {"JpegXl", unsupported, "its pixels are packed as JPEG XL, which is not read", WithSyntax(".4.110")},
      {"HighThroughput", unsupported, "its pixels are packed as high-throughput JPEG 2000, which is not read",
       WithSyntax(".4.201")},
      // read_dicom.cpp
      {"PositionInfinite", geometry, "Image Position in its header is not a finite number",
       With([](DicomFields& f) { f.position = "0\\inf\\0"; })},
      {"SpacingIsText", undecodable, "Pixel Spacing in its header is no number",
       With([](DicomFields& f) { f.spacing = "0,5\\0,5"; })},
      {"SpacingZero", geometry, "Pixel Spacing is not greater than 0",
       With([](DicomFields& f) { f.spacing = "0\\0"; })},
      {"Crooked", geometry, "Image Orientation is not two unit vectors at right angles",
       With([](DicomFields& f) { f.orientation = "1\\0\\0\\1\\0\\0"; })},
      {"SlopeZero", geometry, "Rescale Slope is 0", With([](DicomFields& f) { f.slope = "0"; })},
      {"PaletteMissing", unsupported, "its palette is missing", WithPalette("")},
      {"PaletteSegmented", unsupported, "its palette is segmented, which is not read",
       WithPalette(PaletteTables(4, 8, 4) + Element(0x28, 0x1221, "OW", "1234"))},
      {"PaletteShort", undecodable, "its palette is shorter than it announces",
       WithPalette(PaletteTables(200, 8, 4))},
      {"PaletteOfTwelveBits", undecodable, "its palette's tables are neither of 8 nor 16 bits, or not alike",
       WithPalette(PaletteTables(4, 12, 8))},
      {"ColoursNotSaid", undecodable,
       "it does not say how its colours are stored (Photometric Interpretation)", With([](DicomFields& f) {
         f.shown = "";
         f.more = Element(0x28, 2, "US", Bytes<std::uint16_t>(3));
       })},
      {"ColoursOfAnotherKind", unsupported,
       "its colours are of a kind that is not read: neither grey, RGB, YBR_FULL nor a palette",
       With([](DicomFields& f) { f.shown = "CMYK"; })},
      {"SamplesDoNotFit", undecodable, "Samples per Pixel does not fit its colours",
       With([](DicomFields& f) { f.more = Element(0x28, 2, "US", Bytes<std::uint16_t>(3)); })},
      {"BitsMissing", undecodable, "Bits Allocated is missing or no unsigned short",
       [] {
         std::string file = MakeDicom({});
         return file.erase(file.find(std::string("\x28\0\0\1US", 6)), 10);
       }},
      {"BitsOf32", unsupported, "it has neither 8 nor 16 bits allocated",
       With([](DicomFields& f) { f.allocated = 32; })},
      {"ColoursOf16Bits", unsupported, "its colours have 16 bits each; those of 8 bits are read",
       With([](DicomFields& f) { f.shown = "RGB", f.pixels = std::string(288, '\0'); })},
      {"BitsDisagree", undecodable, "Bits Stored, High Bit and Bits Allocated do not agree",
       With([](DicomFields& f) { f.high = 40; })},
      {"Damaged", undecodable, "its DICOM elements are damaged", {}},
      {"WithoutPixels", truncated, "it ends before its pixels",
       [] {
         const std::string file = MakeDicom({});
         return file.substr(0, file.find(std::string("\xe0\x7f\x10\0OW", 6)));
       }},
      {"RowsOfAnotherType", undecodable, "Rows or Columns is missing or no unsigned short",
       With([](DicomFields& f) {
         f.dimensions = Element(0x28, 0x10, "UL", Bytes<std::uint32_t>(6)) +
                        Element(0x28, 0x11, "US", Bytes<std::uint16_t>(8));
       })},
      {"NoFrames", undecodable, "Number of Frames is not 1, 2, ...", WithFrames("0")},
      {"FramesBeyondAll", large, "it has more than 16384 frames", WithFrames("20000")},
      {"FramesNotDescribed", undecodable, "it describes fewer frames than it holds", With([](DicomFields& f) {
         f.dimensions = Element(0x28, 8, "IS", "2") + Sides(6, 8);
         f.palette =
             Sequence(0x5200, 0x9230, {Sequence(0x20, 0x9113, {Element(0x20, 0x32, "DS", "0\\0\\0")})});
         f.pixels = Samples(8, 6, 2);
       })},
      {"Subsampled", unsupported,
       "its colours are stored as YBR_FULL_422 without being packed, which is not read",
       With([](DicomFields& f) {
         f.shown = "YBR_FULL_422", f.allocated = f.stored = 8, f.high = 7, f.is_signed = 0;
         f.pixels = std::string(96, '\7');
       })},
      {"PixelsCut", truncated, "its header announces 96 bytes of pixels, and it holds 20",
       With([](DicomFields& f) { f.pixels = std::string(20, '\1'); })},
      {"PixelsDamaged", undecodable, "its pixels are damaged or missing", {}},
      {"DecoderRefuses", undecodable, "its decoder finds it damaged", With([](DicomFields& f) {
         f.transfer_syntax = "1.2.840.10008.1.2.5";
         f.pixel_element = Fragments({std::string(200, '\x42')});
       })},
      {"OtherPixels", undecodable, "its pixels are not as many as its header says", {}},
      {"MoreFramesThanBefore", ErrorCode::kImageChanged, "it has more frames than before", {}},
  };
}

/// The error of a file: of its header, of its frames, or of its pixels.
base::Error FailureOf(const fs::path& path) {
  ImportLimits limits;
  limits.most_bytes = 1u << 20;
  ImportPool pool(limits, 1);
  const auto file = ImportFile::Open(path, Links::kRefuse);
  if (!file) return file.error();
  const auto reply = pool.Probe(*file);
  if (!reply) return reply.error();
  if (reply->header.depth > 1) {
    const auto frames = pool.ProbeFrames(*file, reply->header);
    if (!frames) return frames.error();
  }
  const auto buffer = SampleBuffer::Make(reply->header.SampleCount() * SampleBytes(reply->header.samples));
  const auto status = pool.Decode(*file, nullptr, reply->header, *buffer, 0);
  return status.ok() ? base::Error{} : status.error();
}

TEST(DicomMessages, SayWhatIsSo) {
  const TemporaryFolder folder;
  for (const Provoked& one : MakeProvoked()) {
    if (!one.make) continue;
    ASSERT_TRUE(host::WriteFile(folder.Path() / "file", one.make()).ok());
    const base::Error error = FailureOf(folder.Path() / "file");
    EXPECT_EQ(base::CodeText(error.code), base::CodeText(one.code)) << one.name << ": " << error.message;
    EXPECT_THAT(error.message, HasSubstr(one.says)) << one.name;
    EXPECT_THAT(error.message, testing::Not(HasSubstr("Jane"))) << one.name;
  }
}

/// The literals of a source that a person reads: those of two words and more.
std::set<std::string> TextsOf(const std::string& source) {
  std::set<std::string> texts;
  const std::regex literal("\"((?:[^\"\\\\\\n]|\\\\.)*)\"");
  for (std::sregex_iterator it(source.begin(), source.end(), literal), end; it != end; ++it) {
    const std::string text = (*it)[1];
    const bool has_words = text.find(' ') != std::string::npos &&
                           text.find_first_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos;
    if (has_words && text.size() > 8) texts.insert(text);
  }
  return texts;
}

TEST(DicomMessages, AreAllProvoked) {
  std::string said;
  for (const Provoked& one : MakeProvoked()) said += std::string(one.says) + "\n";
  // of one message several pieces; and no message at all
  for (const char* text :
       {" bytes of pixels, and it holds ", " in its header is not a finite number", " MiB allowed",
        "it is a DICOM image", " and holds no slices", "Rescale Intercept", "Number of Frames"})
    said += std::string(text) + "\n";
  for (const char* name : {"dicom_structure.cpp", "dicom_content.cpp", "read_dicom.cpp"}) {
    std::string source = *host::ReadFile(fs::path(TROCAR_SOURCE_DIR) / "src/imaging/images/import" / name);
    // a text over two lines is one
    source = std::regex_replace(source, std::regex("\"\\s*\\n\\s*\""), "");
    const auto texts = TextsOf(std::regex_replace(source, std::regex("//[^\\n]*"), ""));
    EXPECT_FALSE(texts.empty()) << name;
    for (const std::string& text : texts) {
      EXPECT_THAT(said, HasSubstr(text))
          << name << ": \"" << text << "\" is provoked by no file of this test";
    }
  }
}

}  // namespace
}  // namespace trocar::images
