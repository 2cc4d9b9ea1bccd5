// SPDX-License-Identifier: Apache-2.0
/// \file import_protocol.h  Messages between this program and its image reader, a process of its own.
///
/// One request, one reply, both of fixed size, over a SOCK_SEQPACKET socket; files and the memory for samples
/// travel as descriptors. Both programs come from one build, so plain structs do. The reader is not trusted:
/// ReadReply in import_worker.cpp checks every field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

namespace trocar::images {

inline constexpr std::uint32_t kImportVersion = 6;
inline constexpr int kImportSocket = 3;             // descriptor in the reader
inline constexpr int kExitOutOfMemory = 40;         // exit status of the reader
inline constexpr std::size_t kMostDescriptors = 3;  // of one request
inline constexpr std::size_t kMostSegments = 1024;  // an atlas of the whole body names a few hundred
inline constexpr std::uint32_t kMostLayers = 64;    // of segments that overlap

enum class FileKind : std::uint32_t { kUnknown, kJpeg, kPng, kTiff, kDicom, kNifti, kNrrd, kMetaImage };
enum class ImportOperation : std::uint32_t {
  kProbe = 1,
  kDecode = 2,
  kProbeFrames = 3  ///< of a DICOM file: an ImageHeader of each of its frames, into the memory for samples
};

/// Kind of content of a DICOM file. All but pictures lie beside a series and are passed over.
enum class DicomContent : std::uint32_t {
  kPictures,
  kSegmentation,
  kStructures,
  kDose,
  kPlan,
  kReport,
  kKeyObjects,
  kPresentation,
  kDirectory,
  kDocument,
  kRawData,
  kRegistration,
  kWaveform,
  kParametricMap,
  kSurface,
  kOther
};
inline constexpr DicomContent kLastDicomContent = DicomContent::kOther;

/// Attribute that may split the slices of one DICOM series into several volumes, the most telling first.
enum class DicomKey : std::uint32_t {
  kTemporalPosition,
  kAcquisition,
  kEcho,
  kEchoTime,         // [us]
  kDiffusion,        // b-value [0.001 s/mm^2]
  kTriggerTime,      // [us]
  kVoltage,          // of the tube [V]
  kStack,            // hash of its name
  kImageType,        // hash
  kKernel,           // hash
  kAgent,            // hash of the contrast agent's name
  kAcquisitionTime,  // [ms]
  kContentTime       // [ms]
};
inline constexpr std::size_t kDicomKeys = 13;
inline constexpr std::int64_t kKeyNotSaid = INT64_MIN;

/// How samples are handed over, in this computer's byte order. Those of 64 bits are turned into kFloat32.
enum class SampleKind : std::uint32_t { kUint8, kInt16, kUint16, kFloat32, kInt32, kUint32 };
inline constexpr SampleKind kLastSampleKind = SampleKind::kUint32;
inline constexpr std::size_t SampleBytes(SampleKind kind) {
  switch (kind) {
    case SampleKind::kUint8:
      return 1;
    case SampleKind::kInt16:
    case SampleKind::kUint16:
      return 2;
    default:
      return 4;
  }
}

/// Which way the file's own coordinates run.
enum class FileFrame : std::uint32_t { kNotSaid, kLps, kRas };

/// Descriptors that come with it: the file; its data file or none; for kDecode, the memory for samples.
struct ImportRequest {
  std::uint32_t version = kImportVersion;
  ImportOperation operation = ImportOperation::kProbe;
  std::uint32_t has_data_file = 0;
  std::uint32_t most_side = 0;         ///< of a picture [pixels]
  std::uint64_t most_bytes = 0;        ///< of all samples
  std::uint32_t is_size_believed = 0;  ///< 1: the header is not compared with the bytes present (tests only)
  std::uint32_t seconds = 0;           ///< the reader ends itself after this time
  std::uint64_t offset = 0;            ///< kDecode: where in the memory the samples go [bytes]
  std::uint64_t capacity = 0;          ///< kDecode: how many bytes there are from there
};

/// Content of an image file's header. Lengths are in millimetres, directions and places in LPS.
struct ImageHeader {
  FileKind kind = FileKind::kUnknown;
  std::uint32_t width = 0, height = 0, depth = 0;
  std::uint32_t channels = 0;    ///< 1 grey, 3 red, green, blue; or the layers of a segmentation
  std::uint32_t is_layered = 0;  ///< 1: the channels are label maps of one place, whose segments may overlap
  SampleKind samples = SampleKind::kUint8;
  std::uint32_t bits = 0;  ///< of a sample in the file
  FileFrame frame = FileFrame::kNotSaid;
  double spacing[3] = {0, 0, 0};  ///< 0: the file does not say
  double origin[3] = {0, 0, 0};
  double direction[3][3] = {};  ///< [axis] unit vectors; zero where frame is kNotSaid
  double slope = 1, intercept = 0;
  std::uint32_t has_window = 0, is_inverted = 0;  ///< inverted: large values are dark
  double window_centre = 0, window_width = 0;
  // DICOM: hashes, so that no name travels. Content and series are set where a file is refused, too.
  DicomContent content = DicomContent::kPictures;
  std::uint32_t is_localizer = 0, is_ct = 0;
  std::uint64_t series_hash = 0, patient_hash = 0, frame_hash = 0, instance_hash = 0;
  std::int64_t keys[kDicomKeys] = {};  ///< of DicomKey
  std::int32_t instance_number = 0;
  std::uint32_t has_position = 0;  ///< of a single slice: position and orientation were given
  std::uint32_t segments = 0;
  char description[80] = {};  ///< DICOM: kind of images and what the scanner calls the series
  /// Path of the file with the samples, from the header's folder on (IsPathBelow); empty: they follow the header.
  char data_file[256] = {};
  std::uint32_t is_data_beside = 0;  ///< 1: they are in the file of the same name that ends in .img (NIfTI)

  std::uint64_t SampleCount() const {
    return std::uint64_t{width} * height * depth * channels;  // checked to fit by both sides
  }
};

/// Name of a label, as 3D Slicer's NRRD and TotalSegmentator's NIfTI files have them.
struct SegmentName {
  char name[56] = {};
  char code[40] =
      {};  ///< what it is in SNOMED, as LabelVolume::codes has it; empty where the file does not say
  std::int32_t label = 0;
  std::uint32_t layer = 0;  ///< in which channel, where the file is layered
};

struct ImportReply {
  std::uint32_t version = kImportVersion;
  std::int32_t code = 0;  ///< base::ErrorCode
  char why[240] = {};     ///< of an error: plain words without anything from the file
  ImageHeader header;
  SegmentName names[kMostSegments] = {};
};

static_assert(std::is_trivially_copyable_v<ImportRequest> && std::is_trivially_copyable_v<ImportReply>);

/// Whether DICOM elements begin at once, without a preamble: one of group 2 or of the first of group 8, of a known type, or, where
/// types are not written, of a length that such an element has.
inline bool BeginsLikeDataSet(std::string_view begin) {
  if (begin.size() < 8 || begin[1] != 0 || begin[3] != 0 || (begin[0] != 2 && begin[0] != 8)) return false;
  const auto element = static_cast<unsigned char>(begin[2]);
  if (element > 0x18) return false;
  constexpr std::string_view kTypes = "UL UI OB CS SH LO DA TM";
  const std::string_view type = begin.substr(4, 2);
  if (type[0] >= 'A' && type[1] >= 'A' && kTypes.find(type) != std::string_view::npos) return true;
  return begin[0] == 8 && begin[5] == 0 && begin[6] == 0 && begin[7] == 0 &&
         static_cast<unsigned char>(begin[4]) <= 128 && begin[4] % 2 == 0;
}

/// Whether a relative path can only lead to a file in its folder or in folders of that.
inline bool IsPathBelow(std::string_view path) {
  for (;;) {
    const auto end = path.find('/');
    const std::string_view part = path.substr(0, end);
    if (part.empty() || part == "." || part == ".." || part.find('\0') != std::string_view::npos)
      return false;
    if (end == std::string_view::npos) return true;
    path.remove_prefix(end + 1);
  }
}

/// MetaImage has no mark: its lines are "name = value" (or "name : value"), NDims among them.
inline bool BeginsLikeMetaImage(std::string_view begin) {
  if (begin.find('\0') < begin.find("NDims")) return false;
  for (const std::string_view name : {"ObjectType", "NDims"}) {
    if (begin.starts_with(name)) return true;
  }
  const std::string_view line = begin.substr(0, begin.find('\n'));
  return line.find_first_of("=:") != std::string_view::npos &&
         begin.find("\nNDims") != std::string_view::npos;
}

/// The kind of file that begins like this (at least 348 bytes where the file has them; unpacked if gzip).
inline FileKind SniffKind(std::string_view begin) {
  const auto has = [&](std::size_t at, std::string_view text) {
    return begin.size() >= at + text.size() && begin.substr(at, text.size()) == text;
  };
  // the 128 bytes before are anybody's, a TIFF's among them (PS3.10 section 7.1)
  if (has(128, "DICM")) return FileKind::kDicom;
  if (has(0, "\xff\xd8\xff")) return FileKind::kJpeg;
  if (has(0, "\x89PNG\r\n\x1a\n")) return FileKind::kPng;
  if (has(0, std::string_view("II*\0", 4)) || has(0, std::string_view("MM\0*", 4))) return FileKind::kTiff;
  if (has(0, std::string_view("II+\0", 4)) || has(0, std::string_view("MM\0+", 4))) return FileKind::kTiff;
  if (has(0, "NRRD00")) return FileKind::kNrrd;
  if (has(344, std::string_view("n+1\0", 4)) || has(344, std::string_view("ni1\0", 4)) || has(4, "n+2") ||
      has(4, "ni2")) {
    return FileKind::kNifti;
  }
  if (BeginsLikeMetaImage(begin)) return FileKind::kMetaImage;
  return BeginsLikeDataSet(begin) ? FileKind::kDicom : FileKind::kUnknown;
}

}  // namespace trocar::images
