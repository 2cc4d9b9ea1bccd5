// SPDX-License-Identifier: Apache-2.0
// The only file that sees ITK. Its reader classes are used directly, without the object factories.
#include <itkJPEGImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "byte_source.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

/// Bytes of a file by their place in it.
class FileBytes {
 public:
  explicit FileBytes(const InputFile& file) : file_(file) {}
  /// \return fewer only at the end
  std::string At(std::uint64_t begin, std::size_t count) const {
    std::string bytes(count, '\0');
    bytes.resize(OpenPlain(file_, begin)->Read(bytes.data(), count));
    return bytes;
  }
  /// \return as a number with the most significant byte first; nothing behind the end
  std::optional<std::uint32_t> NumberAt(std::uint64_t begin, std::size_t count) const {
    const std::string bytes = At(begin, count);
    if (bytes.size() != count) return std::nullopt;
    std::uint32_t number = 0;
    for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
    return number;
  }

 private:
  InputFile file_;
};

/// Goes from chunk to chunk until the last one, IEND; what follows that belongs to others.
bool ReachesPngEnd(const FileBytes& bytes) {
  constexpr std::uint64_t kMark = 8, kAround = 12;  // length, type and checksum of a chunk
  for (std::uint64_t at = kMark;;) {
    const auto length = bytes.NumberAt(at, 4);
    if (!length) return false;
    if (bytes.At(at + 4, 4) == "IEND") return bytes.NumberAt(at + 8, 4).has_value();
    at += kAround + *length;
  }
}

/// Goes from segment to segment until the picture begins, then looks for the mark of its end.
bool ReachesJpegEnd(const FileBytes& bytes, std::uint64_t file_bytes) {
  constexpr std::uint32_t kStartOfScan = 0xffda;
  std::uint64_t at = 2;
  for (;;) {
    const auto marker = bytes.NumberAt(at, 2), length = bytes.NumberAt(at + 2, 2);
    if (!marker || !length) return false;
    if (*marker == 0xffff) {  // padding
      ++at;
      continue;
    }
    constexpr std::uint32_t kFirstMarker = 0xffc0;  // of those that have a length
    if (*marker < kFirstMarker) return true;        // no JPEG any more: its decoder will say so
    at += 2 + *length;
    if (*marker == kStartOfScan) break;
  }
  constexpr std::size_t kChunk = 1 << 16;
  for (; at < file_bytes; at += kChunk) {
    if (bytes.At(at, kChunk + 1).find("\xff\xd9") != std::string::npos) return true;
  }
  return false;
}

/// JPEG decoders fill what is missing with grey, so a file must reach its end to count as whole.
void CheckWhole(const InputFile& file, FileKind kind) {
  const FileBytes bytes(file);
  const bool is_whole = kind == FileKind::kPng    ? ReachesPngEnd(bytes)
                        : kind == FileKind::kJpeg ? ReachesJpegEnd(bytes, file.bytes)
                                                  : true;
  if (!is_whole) throw Failure{ErrorCode::kImageTruncated, "its end is missing"};
}

/// ITK's PNG reader ends the process where libpng refuses the first chunk.
void CheckPngBegin(const InputFile& file) {
  constexpr std::size_t kBegin = 8 + 4 + 4 + 13 + 4;
  const std::string begin = ReadBegin(file, kBegin);
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(begin[at + i]);
    return value;
  };
  const bool is_first = begin.size() == kBegin && number(8) == 13 && begin.substr(12, 4) == "IHDR";
  if (!is_first || number(16) == 0 || number(20) == 0 ||
      ::crc32(0, reinterpret_cast<const Bytef*>(begin.data() + 12), 17) != number(29)) {
    throw Failure{ErrorCode::kImageUndecodable, "its PNG header is damaged"};
  }
}

/// Fewest bytes that a picture of this size can be packed into.
std::uint64_t FewestBytes(const ImageHeader& header, FileKind kind, std::uint64_t bytes) {
  // JPEG spends at least a bit on each 8 x 8 block; PNG deflates
  constexpr std::uint64_t kMostPixelsAByte = 8 * 64;
  if (kind == FileKind::kJpeg) return std::uint64_t{header.width} * header.height / kMostPixelsAByte;
  if (kind == FileKind::kPng) return bytes / 8 / kMostDeflated;  // down to one bit of its own a sample
  return 0;
}

itk::ImageIOBase::Pointer MakeReader(FileKind kind) {
  switch (kind) {
    case FileKind::kJpeg:
      return itk::JPEGImageIO::New().GetPointer();
    case FileKind::kPng:
      return itk::PNGImageIO::New().GetPointer();
    default:
      return itk::TIFFImageIO::New().GetPointer();
  }
}

template <typename Sample>
void TakeGrey(const std::vector<char>& raw, std::size_t channels, std::uint64_t count, std::byte* to) {
  for (std::uint64_t i = 0; i < count; ++i)
    std::memcpy(to + i * sizeof(Sample), raw.data() + i * channels * sizeof(Sample), sizeof(Sample));
}

}  // namespace

void ReadPicture(const Job& job, FileKind kind, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = kind;
  if (kind == FileKind::kPng) CheckPngBegin(job.file);
  if (job.request.is_size_believed == 0) CheckWhole(job.file, kind);
  const itk::ImageIOBase::Pointer reader = MakeReader(kind);
  reader->SetFileName(job.file.Path());
  reader->ReadImageInformation();
  const unsigned dimensions = reader->GetNumberOfDimensions();
  const std::uint64_t sides[3] = {reader->GetDimensions(0), reader->GetDimensions(1),
                                  dimensions > 2 ? reader->GetDimensions(2) : 1};
  const std::size_t channels = reader->GetNumberOfComponents();
  for (const std::uint64_t side : sides) {
    if (side == 0) throw Failure{ErrorCode::kImageUndecodable, "its header announces no pixels"};
    if (side > job.request.most_side) {
      throw Failure{ErrorCode::kImageTooLarge,
                    "it measures more than " + std::to_string(job.request.most_side) + " pixels a side"};
    }
  }
  header.width = static_cast<std::uint32_t>(sides[0]);
  header.height = static_cast<std::uint32_t>(sides[1]);
  header.depth = static_cast<std::uint32_t>(sides[2]);
  const bool is_wide = reader->GetComponentType() == itk::IOComponentEnum::USHORT;
  const bool is_signed = reader->GetComponentType() == itk::IOComponentEnum::SHORT;
  const bool is_float = reader->GetComponentType() == itk::IOComponentEnum::FLOAT;
  const bool is_byte = reader->GetComponentType() == itk::IOComponentEnum::UCHAR;
  const bool is_grey = channels == 1 || channels == 2;
  if (channels == 0 || channels > 4) {
    throw Failure{
        ErrorCode::kImageUnsupported,
        "it has " + std::to_string(channels) + " channels; grey or colour, also with transparency, is read"};
  }
  if (is_grey && !(is_byte || is_wide || is_signed || is_float)) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its samples are neither integers of 8 or 16 bits nor floating point of 32 bits"};
  }
  if (!is_grey && !(is_byte || is_wide))
    throw Failure{ErrorCode::kImageUnsupported, "its colours have neither 8 nor 16 bits"};
  header.channels = is_grey ? 1 : 3;
  header.bits = is_byte ? 8 : is_float ? 32 : 16;
  header.samples = !is_grey || is_byte ? SampleKind::kUint8
                   : is_float          ? SampleKind::kFloat32
                   : is_signed         ? SampleKind::kInt16
                                       : SampleKind::kUint16;
  CheckSize(header, job.request);
  const std::uint64_t pixels = CheckedProduct({header.width, header.height, header.depth});
  const std::uint64_t raw_bytes = CheckedProduct({pixels, channels, header.bits / 8});
  if (job.request.is_size_believed == 0 && FewestBytes(header, kind, raw_bytes) > job.file.bytes)
    throw Failure{ErrorCode::kImageTruncated, "it is too small for the size in its header"};
  if (job.samples == nullptr) return;

  itk::ImageIORegion region(dimensions);
  for (unsigned axis = 0; axis < dimensions; ++axis) region.SetSize(axis, reader->GetDimensions(axis));
  reader->SetIORegion(region);
  // what is laid out as it is handed over needs no copy
  if (channels == header.channels && (is_grey || is_byte)) {
    reader->Read(job.samples);
    return;
  }
  std::vector<char> raw(raw_bytes);
  reader->Read(raw.data());
  if (is_grey) {
    if (is_byte) return TakeGrey<std::uint8_t>(raw, channels, pixels, job.samples);
    if (is_float) return TakeGrey<float>(raw, channels, pixels, job.samples);
    return TakeGrey<std::uint16_t>(raw, channels, pixels, job.samples);
  }
  // colours of 16 bits are shown by their upper half
  const std::size_t sample_bytes = header.bits / 8;
  for (std::uint64_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      job.samples[3 * i + c] =
          static_cast<std::byte>(raw[(i * channels + c) * sample_bytes + sample_bytes - 1]);
  }
}

}  // namespace trocar::images::import
