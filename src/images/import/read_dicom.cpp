// SPDX-License-Identifier: Apache-2.0
// The only file that sees GDCM. Source: DICOM PS3.3 sections C.7.6.2, C.7.6.3 and C.11.
#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmMediaStorage.h>
#include <gdcmReader.h>
#include <gdcmTag.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "dicom_structure.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using core::ErrorCode;
using gdcm::Tag;

const Tag kPixelData(0x7FE0, 0x0010);

std::string_view FindBytes(const gdcm::DataSet& data, Tag tag) {
  if (!data.FindDataElement(tag)) return {};
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  if (bytes == nullptr || bytes->GetPointer() == nullptr) return {};
  return {bytes->GetPointer(), bytes->GetLength()};
}

/// Texts are padded with a blank or a zero byte.
std::string_view FindText(const gdcm::DataSet& data, Tag tag) {
  std::string_view text = FindBytes(data, tag);
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  return Trimmed(text);
}

/// Decimal strings, parted by backslashes.
std::vector<double> FindNumbers(const gdcm::DataSet& data, Tag tag, const char* name) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(FindText(data, tag), "\\")) {
    const std::string_view text = Trimmed(word);
    numbers.push_back(ParseNumber(text, name));
    if (!std::isfinite(numbers.back()))
      throw Failure{ErrorCode::kImageGeometryInvalid,
                    std::string(name) + " in its header is not a finite number"};
  }
  return numbers;
}

/// Unsigned short; nothing when it is missing, of another length or another type.
std::optional<unsigned> FindShort(const gdcm::DataSet& data, Tag tag) {
  const std::string_view bytes = FindBytes(data, tag);
  if (bytes.size() != 2) return std::nullopt;
  std::uint16_t value = 0;
  std::memcpy(&value, bytes.data(), 2);
  return value;
}

constexpr std::string_view kPalette = "PALETTE COLOR";

/// Colours by stored value, as PS3.3 section C.7.6.3.1.5 has them; of wider entries the upper byte.
struct Palette {
  int first = 0;  // stored value of the first colour
  std::vector<std::array<std::uint8_t, 3>> colors;

  const std::array<std::uint8_t, 3>& At(int value) const {
    return colors[static_cast<std::size_t>(
        std::clamp(value - first, 0, static_cast<int>(colors.size()) - 1))];
  }
};

Palette ReadPalette(const gdcm::DataSet& data) {
  Palette palette;
  for (std::uint16_t c = 0; c < 3; ++c) {
    const std::string_view about = FindBytes(data, Tag(0x0028, static_cast<std::uint16_t>(0x1101 + c)));
    const std::string_view table = FindBytes(data, Tag(0x0028, static_cast<std::uint16_t>(0x1201 + c)));
    std::array<std::uint16_t, 3> descriptor{};  // entries, first stored value, bits of an entry
    if (about.size() != sizeof(descriptor))
      throw Failure{ErrorCode::kImageUnsupported, "its palette is missing or segmented"};
    std::memcpy(descriptor.data(), about.data(), sizeof(descriptor));
    const std::size_t count = descriptor[0] == 0 ? 65536 : descriptor[0];
    const std::size_t bytes = table.size() >= 2 * count ? 2 : 1;
    if ((descriptor[2] != 8 && descriptor[2] != 16) || (descriptor[2] == 16 && bytes == 1) ||
        table.size() < bytes * count || (c > 0 && count != palette.colors.size()))
      throw Failure{ErrorCode::kImageUndecodable, "its palette is shorter than it announces"};
    palette.first = static_cast<std::int16_t>(descriptor[1]);
    palette.colors.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t byte = bytes * i + (descriptor[2] == 16 ? 1 : 0);
      palette.colors[i][c] = static_cast<std::uint8_t>(table[byte]);
    }
  }
  return palette;
}

/// Source: PS3.3 section C.7.6.3.1.2, YBR_FULL.
std::array<std::uint8_t, 3> ToRgb(double y, double b, double r) {
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  };
  b -= 128, r -= 128;
  return {byte(y + 1.402 * r), byte(y - 0.344136 * b - 0.714136 * r), byte(y + 1.772 * b)};
}

/// FNV-1a; identifiers leave this program as numbers only.
std::uint64_t Hash(std::string_view text, std::uint64_t hash = 14695981039346656037ull) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

void ReadGeometry(const gdcm::DataSet& data, ImageHeader& header) {
  const auto spacing = FindNumbers(data, Tag(0x0028, 0x0030), "Pixel Spacing");
  if (spacing.size() >= 2) header.spacing[0] = spacing[1], header.spacing[1] = spacing[0];
  for (const double length : spacing) {
    if (!(length > 0)) throw Failure{ErrorCode::kImageGeometryInvalid, "Pixel Spacing is not greater than 0"};
  }
  const auto position = FindNumbers(data, Tag(0x0020, 0x0032), "Image Position");
  const auto orientation = FindNumbers(data, Tag(0x0020, 0x0037), "Image Orientation");
  if (position.size() != 3 || orientation.size() != 6) return;
  header.has_position = 1;
  header.frame = FileFrame::kLps;
  double lengths[2] = {0, 0}, along = 0;
  for (int k = 0; k < 3; ++k) {
    header.origin[k] = position[k];
    for (int axis = 0; axis < 2; ++axis) {
      header.direction[axis][k] = orientation[3 * axis + k];
      lengths[axis] += orientation[3 * axis + k] * orientation[3 * axis + k];
    }
    along += orientation[k] * orientation[3 + k];
  }
  constexpr double kTolerance = 1e-3;  // six-digit decimal strings are better than this
  if (std::fabs(lengths[0] - 1) > kTolerance || std::fabs(lengths[1] - 1) > kTolerance ||
      std::fabs(along) > kTolerance) {
    throw Failure{ErrorCode::kImageGeometryInvalid,
                  "Image Orientation is not two unit vectors at right angles"};
  }
  const auto& a = header.direction[0];
  const auto& b = header.direction[1];
  for (int k = 0; k < 3; ++k)
    header.direction[2][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

void ReadGreyValues(const gdcm::DataSet& data, ImageHeader& header) {
  const auto slope = FindNumbers(data, Tag(0x0028, 0x1053), "Rescale Slope");
  const auto intercept = FindNumbers(data, Tag(0x0028, 0x1052), "Rescale Intercept");
  if (!slope.empty()) header.slope = slope[0];
  if (!intercept.empty()) header.intercept = intercept[0];
  if (header.slope == 0) throw Failure{ErrorCode::kImageGeometryInvalid, "Rescale Slope is 0"};
  const auto centre = FindNumbers(data, Tag(0x0028, 0x1050), "Window Center");
  const auto width = FindNumbers(data, Tag(0x0028, 0x1051), "Window Width");
  if (!centre.empty() && !width.empty() && width[0] >= 1) {
    header.has_window = 1;
    header.window_centre = centre[0];
    header.window_width = width[0];
  }
}

/// \return bits that a pixel has in the file
unsigned ReadPixelKind(const gdcm::DataSet& data, ImageHeader& header) {
  const std::string_view shown = FindText(data, Tag(0x0028, 0x0004));
  const unsigned channels = FindShort(data, Tag(0x0028, 0x0002)).value_or(1);
  const auto allocated = FindShort(data, Tag(0x0028, 0x0100));
  const auto stored = FindShort(data, Tag(0x0028, 0x0101));
  const auto high = FindShort(data, Tag(0x0028, 0x0102));
  const bool is_signed = FindShort(data, Tag(0x0028, 0x0103)).value_or(0) == 1;
  const bool is_grey = shown == "MONOCHROME1" || shown == "MONOCHROME2";
  const bool has_palette = shown == kPalette;
  if (!is_grey && !has_palette && shown != "RGB" && shown != "YBR_FULL" && shown != "YBR_FULL_422" &&
      shown != "YBR_RCT" && shown != "YBR_ICT") {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its colours are of a kind that is not read: neither grey, RGB, YBR_FULL nor a palette"};
  }
  header.is_inverted = shown == "MONOCHROME1";
  header.channels = is_grey ? 1 : 3;
  if (channels != (has_palette ? 1 : header.channels))
    throw Failure{ErrorCode::kImageUndecodable, "Samples per Pixel does not fit its colours"};
  if (!allocated || (*allocated != 8 && *allocated != 16) || (channels == 3 && *allocated != 8))
    throw Failure{ErrorCode::kImageUnsupported, "it has neither 8 nor 16 bits allocated"};
  if (!stored || !high || *stored == 0 || *stored > *allocated || *high >= *allocated || *high + 1 < *stored)
    throw Failure{ErrorCode::kImageUndecodable, "Bits Stored, High Bit and Bits Allocated do not agree"};
  header.bits = has_palette ? 8 : *stored;
  if (has_palette) ReadPalette(data);  // complains now, not when the pixels are wanted
  header.samples = header.channels == 3 ? SampleKind::kUint8
                   : is_signed          ? SampleKind::kInt16
                   : *allocated == 8    ? SampleKind::kUint8
                                        : SampleKind::kUint16;
  return *allocated * channels;
}

/// All but the pixels.
void ReadHeader(const Job& job, ImageHeader& header) {
  DicomStructure structure;
  if (job.request.is_size_believed == 0) structure = CheckStructure(job.file);
  std::ifstream stream(job.file.Path(), std::ios::binary);
  gdcm::Reader reader;
  reader.SetStream(stream);
  if (!reader.ReadUpToTag(kPixelData))
    throw Failure{ErrorCode::kImageUndecodable, "its DICOM elements are damaged"};
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  const auto rows = FindShort(data, Tag(0x0028, 0x0010)), columns = FindShort(data, Tag(0x0028, 0x0011));
  gdcm::MediaStorage storage;
  storage.SetFromFile(reader.GetFile());
  if (!rows && !columns && !gdcm::MediaStorage::IsImage(storage))
    throw Failure{ErrorCode::kImageUnsupported, kWithoutPicture};
  if (job.request.is_size_believed == 0 && !structure.has_pixels)
    throw Failure{ErrorCode::kImageTruncated, "it ends before its pixels"};
  if (!rows || !columns)
    throw Failure{ErrorCode::kImageUndecodable, "Rows or Columns is missing or no unsigned short"};
  header.width = *columns;
  header.height = *rows;
  header.depth = 1;
  const auto frames = FindNumbers(data, Tag(0x0028, 0x0008), "Number of Frames");
  if (!frames.empty() && frames[0] != 1)
    throw Failure{ErrorCode::kImageUnsupported,
                  "it holds several frames; split it into one file a slice, or convert it to NIfTI"};
  const std::uint64_t pixel_bytes = ReadPixelKind(data, header) / 8;
  ReadGreyValues(data, header);
  ReadGeometry(data, header);
  CheckGeometry(header);
  CheckSize(header, job.request);
  header.series_hash = Hash(FindText(data, Tag(0x0020, 0x000E)));
  header.frame_hash = Hash(FindText(data, Tag(0x0020, 0x0052)));
  header.patient_hash = Hash(FindText(data, Tag(0x0010, 0x0020)), Hash(FindText(data, Tag(0x0010, 0x0010))));
  const std::string_view modality = FindText(data, Tag(0x0008, 0x0060));
  std::string description(modality);
  if (const auto name = FindText(data, Tag(0x0008, 0x103E)); !name.empty())
    description += (description.empty() ? "" : ", ") + std::string(name);
  description.copy(header.description, sizeof(header.description) - 1);
  const auto instance = FindNumbers(data, Tag(0x0020, 0x0013), "Instance Number");
  if (!instance.empty() && std::fabs(instance[0]) < 1e6)
    header.instance_number = static_cast<std::int32_t>(instance[0]);

  if (job.request.is_size_believed != 0) return;
  const std::uint64_t needed = header.SampleCount() / header.channels * pixel_bytes;
  if (!structure.is_encapsulated && structure.pixel_bytes < needed) {
    throw Failure{ErrorCode::kImageTruncated, "its header announces " + std::to_string(needed) +
                                                  " bytes of pixels, and it holds " +
                                                  std::to_string(structure.pixel_bytes)};
  }
}

/// Leaves palettes to us: GDCM ends the program on tables that do not begin at the stored value 0.
class PixelReader : public gdcm::ImageReader {
 public:
  bool HasPalette() const { return has_palette_; }

 protected:
  bool ReadImage(const gdcm::MediaStorage& storage) override {
    gdcm::DataSet& data = GetFile().GetDataSet();
    has_palette_ = FindText(data, Tag(0x0028, 0x0004)) == kPalette;
    if (has_palette_) {
      gdcm::Attribute<0x0028, 0x0004> shown;
      shown.SetValue("MONOCHROME2");
      data.Replace(shown.GetAsDataElement());
    }
    return gdcm::ImageReader::ReadImage(storage);
  }

 private:
  bool has_palette_ = false;
};

void ReadPixels(const Job& job, const ImageHeader& header) {
  std::ifstream stream(job.file.Path(), std::ios::binary);
  PixelReader reader;
  reader.SetStream(stream);
  if (!reader.Read()) throw Failure{ErrorCode::kImageUndecodable, "its pixels are damaged or missing"};
  const gdcm::Image& image = reader.GetImage();
  const std::size_t sample_bytes = image.GetPixelFormat().GetBitsAllocated() / 8;
  const auto shown = image.GetPhotometricInterpretation();  // after decoding
  const std::uint64_t expected = header.SampleCount() * sample_bytes / (reader.HasPalette() ? 3 : 1);
  if (image.GetNumberOfDimensions() != 2 || image.GetDimension(0) != header.width ||
      image.GetDimension(1) != header.height || image.GetBufferLength() != expected) {
    throw Failure{ErrorCode::kImageUndecodable, "its pixels are not as many as its header says"};
  }
  std::vector<char> raw(expected);
  if (!image.GetBuffer(raw.data()))
    throw Failure{ErrorCode::kImageUndecodable, "its decoder finds it damaged"};
  if (reader.HasPalette()) {
    const Palette palette = ReadPalette(reader.GetFile().GetDataSet());
    const bool is_signed = image.GetPixelFormat().GetPixelRepresentation() == 1;
    for (std::uint64_t i = 0; i < expected / sample_bytes; ++i) {
      std::uint16_t value = 0;
      std::memcpy(&value, raw.data() + sample_bytes * i, sample_bytes);
      const int stored = !is_signed          ? value
                         : sample_bytes == 1 ? static_cast<std::int8_t>(value)
                                             : static_cast<std::int16_t>(value);
      const auto& color = palette.At(stored);
      for (std::size_t c = 0; c < 3; ++c) job.samples[3 * i + c] = static_cast<std::byte>(color[c]);
    }
    return;
  }
  if (header.channels == 3) {
    const std::uint64_t plane = expected / 3;
    const bool is_planar = image.GetPlanarConfiguration() == 1;
    for (std::uint64_t i = 0; i < plane; ++i) {
      for (std::uint64_t c = 0; c < 3; ++c)
        job.samples[3 * i + c] = static_cast<std::byte>(raw[is_planar ? c * plane + i : 3 * i + c]);
    }
    if (shown != gdcm::PhotometricInterpretation::YBR_FULL &&
        shown != gdcm::PhotometricInterpretation::YBR_FULL_422)
      return;
    for (std::byte* p = job.samples; p != job.samples + 3 * plane; p += 3) {
      const auto color =
          ToRgb(std::to_integer<int>(p[0]), std::to_integer<int>(p[1]), std::to_integer<int>(p[2]));
      for (std::size_t c = 0; c < 3; ++c) p[c] = static_cast<std::byte>(color[c]);
    }
    return;
  }
  if (sample_bytes == SampleBytes(header.samples)) {
    std::memcpy(job.samples, raw.data(), raw.size());
    return;
  }
  for (std::size_t i = 0; i < raw.size(); ++i) {  // signed bytes
    const auto value = static_cast<std::int16_t>(static_cast<signed char>(raw[i]));
    std::memcpy(job.samples + 2 * i, &value, 2);
  }
}

}  // namespace

void ReadDicom(const Job& job, ImportReply& reply) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  reply.header.kind = FileKind::kDicom;
  ReadHeader(job, reply.header);
  if (job.samples != nullptr) ReadPixels(job, reply.header);
}

}  // namespace trocar::images::import
