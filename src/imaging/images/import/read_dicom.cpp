// SPDX-License-Identifier: Apache-2.0
// The only file that sees GDCM. Source: DICOM PS3.3 sections C.7.6.2, C.7.6.3 and C.11.
#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmMediaStorage.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmSmartPointer.h>
#include <gdcmTag.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "dicom_content.h"
#include "dicom_structure.h"
#include "header_text.h"
#include "reader.h"
#include "trocar/base/to_integer.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;
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
std::vector<double> ToNumbers(std::string_view texts, const char* name) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(texts, "\\")) {
    const std::string_view text = Trimmed(word);
    numbers.push_back(ParseNumber(text, name));
    if (!std::isfinite(numbers.back()))
      throw Failure{ErrorCode::kImageGeometryInvalid,
                    std::string(name) + " in its header is not a finite number"};
  }
  return numbers;
}

/// The first of them; nothing where there is none that makes sense. For what an image can do without.
std::optional<double> ToNumber(std::string_view texts) {
  const auto words = Words(texts, "\\");
  if (words.empty()) return std::nullopt;
  std::string_view text = Trimmed(words[0]);
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || !(std::fabs(number) < 1e12))
    return std::nullopt;
  return number;
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
    if (data.FindDataElement(Tag(0x0028, static_cast<std::uint16_t>(0x1221 + c))))
      throw Failure{ErrorCode::kImageUnsupported, "its palette is segmented, which is not read"};
    if (about.size() != sizeof(descriptor) || table.empty())
      throw Failure{ErrorCode::kImageUnsupported, "its palette is missing"};
    std::memcpy(descriptor.data(), about.data(), sizeof(descriptor));
    const std::size_t count = descriptor[0] == 0 ? 65536 : descriptor[0];
    const std::size_t bytes = table.size() >= 2 * count ? 2 : 1;
    if ((descriptor[2] != 8 && descriptor[2] != 16) || (c > 0 && count != palette.colors.size()))
      throw Failure{ErrorCode::kImageUndecodable,
                    "its palette's tables are neither of 8 nor 16 bits, or not alike"};
    if ((descriptor[2] == 16 && bytes == 1) || table.size() < bytes * count)
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
  const auto byte = [](double value) { return base::RoundTo<std::uint8_t>(std::clamp(value, 0.0, 255.0)); };
  b -= 128, r -= 128;
  return {byte(y + 1.402 * r), byte(y - 0.344136 * b - 0.714136 * r), byte(y + 1.772 * b)};
}

/// FNV-1a; identifiers leave this program as numbers only.
std::uint64_t Hash(std::string_view text, std::uint64_t hash = 14695981039346656037ull) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

/// Elements of one picture: enhanced files say most of them in functional groups, of each frame or of all (PS3.3 section C.7.6.16).
class FrameElements {
 public:
  FrameElements(const gdcm::DataSet& data, std::size_t frame) : data_(data) {
    per_frame_ = Item(data, Tag(0x5200, 0x9230), frame);
    shared_ = Item(data, Tag(0x5200, 0x9229), 0);
  }

  /// The bytes of `tag` within the functional group `group`; empty where no group has them.
  std::string_view FindBytesInGroup(Tag group, Tag tag) {
    for (const gdcm::DataSet* groups : {per_frame_, shared_}) {
      if (groups == nullptr) continue;
      const gdcm::DataSet* inside = Item(*groups, group, 0);
      if (inside != nullptr && inside->FindDataElement(tag)) return FindBytes(*inside, tag);
    }
    return {};
  }
  /// Likewise as text, else that of the file.
  std::string_view Text(Tag group, Tag tag) {
    for (const gdcm::DataSet* groups : {per_frame_, shared_}) {
      if (groups == nullptr) continue;
      const gdcm::DataSet* inside = Item(*groups, group, 0);
      if (inside != nullptr && inside->FindDataElement(tag)) return FindText(*inside, tag);
    }
    return FindText(data_, tag);
  }
  std::string_view FileText(Tag tag) const { return FindText(data_, tag); }
  /// Floating point of 64 bits, in a group or of the file; or a decimal string of the file.
  std::optional<double> FindDouble(Tag group, Tag tag) {
    std::string_view bytes = FindBytesInGroup(group, tag);
    if (bytes.empty()) bytes = FindBytes(data_, tag);
    double number = 0;
    if (bytes.size() != sizeof(number)) return ToNumber(FindText(data_, tag));
    std::memcpy(&number, bytes.data(), sizeof(number));
    return std::fabs(number) < 1e12 ? std::optional(number) : std::nullopt;
  }

 private:
  /// Item `index` of a sequence; null where there is none.
  const gdcm::DataSet* Item(const gdcm::DataSet& data, Tag tag, std::size_t index) {
    if (!data.FindDataElement(tag)) return nullptr;
    kept_.push_back(data.GetDataElement(tag).GetValueAsSQ());
    const auto& items = kept_.back();
    if (items == nullptr || index >= items->GetNumberOfItems()) return nullptr;
    return &items->GetItem(index + 1).GetNestedDataSet();
  }

  const gdcm::DataSet& data_;
  std::vector<gdcm::SmartPointer<gdcm::SequenceOfItems>> kept_;
  const gdcm::DataSet *per_frame_ = nullptr, *shared_ = nullptr;
};

void ReadGeometry(FrameElements& elements, std::uint32_t frames, ImageHeader& header) {
  const auto spacing = ToNumbers(elements.Text(Tag(0x0028, 0x9110), Tag(0x0028, 0x0030)), "Pixel Spacing");
  if (spacing.size() >= 2) header.spacing[0] = spacing[1], header.spacing[1] = spacing[0];
  for (const double length : spacing) {
    if (!(length > 0)) throw Failure{ErrorCode::kImageGeometryInvalid, "Pixel Spacing is not greater than 0"};
  }
  const Tag position_group(0x0020, 0x9113), position_tag(0x0020, 0x0032);
  // where the file says one place, that is of one of its frames
  if (frames > 1 && elements.FindBytesInGroup(position_group, position_tag).empty()) return;
  const auto position = ToNumbers(elements.Text(position_group, position_tag), "Image Position");
  const auto orientation =
      ToNumbers(elements.Text(Tag(0x0020, 0x9116), Tag(0x0020, 0x0037)), "Image Orientation");
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

void ReadGreyValues(FrameElements& elements, ImageHeader& header) {
  const Tag rescale(0x0028, 0x9145), window(0x0028, 0x9132);
  const auto slope = ToNumbers(elements.Text(rescale, Tag(0x0028, 0x1053)), "Rescale Slope");
  const auto intercept = ToNumbers(elements.Text(rescale, Tag(0x0028, 0x1052)), "Rescale Intercept");
  if (!slope.empty()) header.slope = slope[0];
  if (!intercept.empty()) header.intercept = intercept[0];
  if (header.slope == 0) throw Failure{ErrorCode::kImageGeometryInvalid, "Rescale Slope is 0"};
  const auto centre = ToNumber(elements.Text(window, Tag(0x0028, 0x1050)));
  const auto width = ToNumber(elements.Text(window, Tag(0x0028, 0x1051)));
  if (centre && width && *width >= 1) {
    header.has_window = 1;
    header.window_centre = *centre;
    header.window_width = *width;
  }
}

/// Milliseconds of a date (YYYYMMDD) and a time (HHMMSS.ffffff), for order and distance only.
std::int64_t ToMilliseconds(std::string_view date, std::string_view time) {
  std::string digits;
  for (const char c : time.substr(0, time.find('.'))) {
    if (c >= '0' && c <= '9') digits += c;
  }
  if (digits.size() < 2) return kKeyNotSaid;
  digits.resize(6, '0');
  const auto number = [](std::string_view text) {
    std::int64_t value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  };
  const std::string_view d = digits;
  const std::int64_t seconds =
      number(d.substr(0, 2)) * 3600 + number(d.substr(2, 2)) * 60 + number(d.substr(4, 2));
  std::int64_t thousandths = 0;
  if (const auto dot = time.find('.'); dot != std::string_view::npos) {
    std::string part(time.substr(dot + 1, 3));
    part.resize(3, '0');
    thousandths = number(part);
  }
  const std::int64_t days = date.size() >= 8 ? number(date.substr(0, 4)) * 372 +
                                                   number(date.substr(4, 2)) * 31 + number(date.substr(6, 2))
                                             : 0;
  return (days * 86400 + seconds) * 1000 + thousandths;
}

/// What may tell the volumes of one series apart.
void ReadKeys(FrameElements& elements, ImageHeader& header) {
  const auto set = [&](DicomKey key, std::optional<double> value, double scale) {
    header.keys[static_cast<std::size_t>(key)] =
        value ? base::RoundTo<std::int64_t>(*value * scale) : kKeyNotSaid;
  };
  const auto set_text = [&](DicomKey key, std::string_view text) {
    // half the hash: its sign says nothing
    header.keys[static_cast<std::size_t>(key)] =
        text.empty() ? kKeyNotSaid : static_cast<std::int64_t>(Hash(text) >> 1);
  };
  const Tag content(0x0020, 0x9111);
  const auto whole_in_content = [&](Tag tag) -> std::optional<double> {
    const std::string_view bytes = elements.FindBytesInGroup(content, tag);
    if (bytes.size() == 2) {
      std::uint16_t value = 0;
      std::memcpy(&value, bytes.data(), 2);
      return value;
    }
    std::uint32_t value = 0;
    if (bytes.size() != sizeof(value)) return std::nullopt;
    std::memcpy(&value, bytes.data(), sizeof(value));
    return value;
  };
  const auto either = [](std::optional<double> first, std::optional<double> second) {
    return first ? first : second;
  };
  set(DicomKey::kTemporalPosition,
      either(whole_in_content(Tag(0x0020, 0x9128)), ToNumber(elements.FileText(Tag(0x0020, 0x0100)))), 1);
  set(DicomKey::kAcquisition,
      either(whole_in_content(Tag(0x0020, 0x9156)), ToNumber(elements.FileText(Tag(0x0020, 0x0012)))), 1);
  set(DicomKey::kEcho, ToNumber(elements.FileText(Tag(0x0018, 0x0086))), 1);
  set(DicomKey::kEchoTime,
      either(elements.FindDouble(Tag(0x0018, 0x9114), Tag(0x0018, 0x9082)),
             ToNumber(elements.FileText(Tag(0x0018, 0x0081)))),
      1000);
  set(DicomKey::kDiffusion, elements.FindDouble(Tag(0x0018, 0x9117), Tag(0x0018, 0x9087)), 1000);
  set(DicomKey::kTriggerTime,
      either(elements.FindDouble(Tag(0x0018, 0x9118), Tag(0x0020, 0x9153)),
             ToNumber(elements.FileText(Tag(0x0018, 0x1060)))),
      1000);
  set(DicomKey::kVoltage, ToNumber(elements.Text(Tag(0x0018, 0x9325), Tag(0x0018, 0x0060))), 1000);
  set_text(DicomKey::kStack, elements.Text(content, Tag(0x0020, 0x9056)));
  std::string_view type = elements.Text(Tag(0x0018, 0x9329), Tag(0x0008, 0x9007));
  if (type.empty()) type = elements.Text(Tag(0x0018, 0x9226), Tag(0x0008, 0x9007));
  if (type.empty()) type = elements.FileText(Tag(0x0008, 0x0008));
  set_text(DicomKey::kImageType, type);
  header.is_localizer = type.find("LOCALIZER") != std::string_view::npos ? 1 : 0;
  set_text(DicomKey::kKernel, elements.Text(Tag(0x0018, 0x9314), Tag(0x0018, 0x1210)));
  set_text(DicomKey::kAgent, elements.FileText(Tag(0x0018, 0x0010)));
  const auto moment = [&](std::string_view date_time, Tag date, Tag time) {
    if (date_time.size() > 8) return ToMilliseconds(date_time.substr(0, 8), date_time.substr(8));
    return ToMilliseconds(elements.FileText(date), elements.FileText(time));
  };
  std::string_view acquired = elements.Text(content, Tag(0x0018, 0x9074));
  if (acquired.empty()) acquired = elements.FileText(Tag(0x0008, 0x002A));
  header.keys[static_cast<std::size_t>(DicomKey::kAcquisitionTime)] =
      moment(acquired, Tag(0x0008, 0x0022), Tag(0x0008, 0x0032));
  header.keys[static_cast<std::size_t>(DicomKey::kContentTime)] =
      moment({}, Tag(0x0008, 0x0023), Tag(0x0008, 0x0033));
}

/// \return bits that a pixel has in the file
unsigned ReadPixelKind(const gdcm::DataSet& data, ImageHeader& header) {
  std::string_view shown = FindText(data, Tag(0x0028, 0x0004));
  const unsigned channels = FindShort(data, Tag(0x0028, 0x0002)).value_or(1);
  // from before it had to be said
  if (shown.empty() && channels == 1) shown = "MONOCHROME2";
  const auto allocated = FindShort(data, Tag(0x0028, 0x0100));
  const auto stored = FindShort(data, Tag(0x0028, 0x0101));
  const auto high = FindShort(data, Tag(0x0028, 0x0102));
  const bool is_signed = FindShort(data, Tag(0x0028, 0x0103)).value_or(0) == 1;
  const bool is_grey = shown == "MONOCHROME1" || shown == "MONOCHROME2";
  const bool has_palette = shown == kPalette;
  if (shown.empty())
    throw Failure{ErrorCode::kImageUndecodable,
                  "it does not say how its colours are stored (Photometric Interpretation)"};
  if (!is_grey && !has_palette && shown != "RGB" && shown != "YBR_FULL" && shown != "YBR_FULL_422" &&
      shown != "YBR_RCT" && shown != "YBR_ICT") {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its colours are of a kind that is not read: neither grey, RGB, YBR_FULL nor a palette"};
  }
  header.is_inverted = shown == "MONOCHROME1";
  header.channels = is_grey ? 1 : 3;
  if (channels != (has_palette ? 1 : header.channels))
    throw Failure{ErrorCode::kImageUndecodable, "Samples per Pixel does not fit its colours"};
  if (!allocated)
    throw Failure{ErrorCode::kImageUndecodable, "Bits Allocated is missing or no unsigned short"};
  if (*allocated != 8 && *allocated != 16)
    throw Failure{ErrorCode::kImageUnsupported, "it has neither 8 nor 16 bits allocated"};
  if (channels == 3 && *allocated != 8)
    throw Failure{ErrorCode::kImageUnsupported, "its colours have 16 bits each; those of 8 bits are read"};
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

/// The part of a header that tells where a file belongs, also where it is refused.
void Identify(const DicomStructure& structure, ImageHeader& header) {
  header.content = FindContent(structure.sop_class, structure.modality);
  if (!structure.series.empty()) header.series_hash = Hash(structure.series);
}

[[noreturn]] void RefuseContent(DicomContent content) {
  throw Failure{ErrorCode::kImageSliceMissing,
                std::string(DescribeContent(content)) + " and holds no slices"};
}

/// An image's elements, with GDCM.
struct DicomFile {
  DicomFile(const Job& job, ImageHeader& header) : bytes(job.file, job.request.most_bytes + kMostElements) {
    if (job.request.is_size_believed == 0) {
      std::optional<Failure> damage;
      try {
        CheckStructure(bytes.Get(), structure);
      } catch (const Failure& failure) {
        damage = failure;
      }
      Identify(structure, header);
      // of what is no image in any case it does not matter whether it is whole
      if (header.content != DicomContent::kPictures) RefuseContent(header.content);
      if (damage) throw *damage;
      if (!structure.has_pixels) {
        const auto storage = gdcm::MediaStorage::GetMSType(structure.sop_class.c_str());
        if (structure.has_rows || gdcm::MediaStorage::IsImage(storage))
          throw Failure{ErrorCode::kImageTruncated, "it ends before its pixels"};
        header.content = DicomContent::kOther;
        RefuseContent(header.content);
      }
    }
    stream = Open(job);
    reader.SetStream(*stream);
    if (!reader.ReadUpToTag(kPixelData))
      throw Failure{ErrorCode::kImageUndecodable, "its DICOM elements are damaged"};
  }
  /// Another look at the file from its beginning.
  std::unique_ptr<std::istream> Open(const Job& job) const {
    // without the filling, which GDCM would take for elements
    if (bytes.IsRewritten() || structure.end < bytes.Get().size())
      return std::make_unique<std::istringstream>(std::string(bytes.Get().substr(0, structure.end)));
    return std::make_unique<std::ifstream>(job.file.Path(), std::ios::binary);
  }
  const gdcm::DataSet& Data() const { return reader.GetFile().GetDataSet(); }

  static constexpr std::uint64_t kMostElements = 64u << 20;  // beside the pixels
  DicomBytes bytes;
  DicomStructure structure;
  std::unique_ptr<std::istream> stream;
  gdcm::Reader reader;
};

/// What differs from frame to frame.
void ReadFrame(const gdcm::DataSet& data, std::size_t frame, std::uint32_t frames, ImageHeader& header) {
  FrameElements elements(data, frame);
  ReadGreyValues(elements, header);
  ReadGeometry(elements, frames, header);
  CheckGeometry(header);
  ReadKeys(elements, header);
  const auto instance = ToNumber(elements.FileText(Tag(0x0020, 0x0013)));
  if (frames > 1)
    header.instance_number = static_cast<std::int32_t>(frame) + 1;
  else if (instance && std::fabs(*instance) < 1e6)
    header.instance_number = base::TruncateTo<std::int32_t>(*instance);
}

/// All but the pixels.
void ReadHeader(const Job& job, const DicomFile& file, ImageHeader& header) {
  const gdcm::DataSet& data = file.Data();
  const DicomStructure& structure = file.structure;
  const auto rows = FindShort(data, Tag(0x0028, 0x0010)), columns = FindShort(data, Tag(0x0028, 0x0011));
  if (!rows || !columns)
    throw Failure{ErrorCode::kImageUndecodable, "Rows or Columns is missing or no unsigned short"};
  header.width = *columns;
  header.height = *rows;
  header.depth = 1;
  const auto frames = ToNumbers(FindText(data, Tag(0x0028, 0x0008)), "Number of Frames");
  if (!frames.empty()) {
    if (!(frames[0] >= 1) || frames[0] != std::floor(frames[0]))
      throw Failure{ErrorCode::kImageUndecodable, "Number of Frames is not 1, 2, ..."};
    if (frames[0] > job.request.most_side)
      throw Failure{ErrorCode::kImageTooLarge,
                    "it has more than " + std::to_string(job.request.most_side) + " frames"};
    header.depth = base::TruncateTo<std::uint32_t>(frames[0]);
  }
  const std::uint64_t pixel_bytes = ReadPixelKind(data, header) / 8;
  ReadFrame(data, 0, header.depth, header);
  CheckSize(header, job.request);
  header.series_hash = Hash(FindText(data, Tag(0x0020, 0x000E)));
  if (const auto instance = FindText(data, Tag(0x0008, 0x0018)); !instance.empty())
    header.instance_hash = Hash(instance);
  header.frame_hash = Hash(FindText(data, Tag(0x0020, 0x0052)));
  header.patient_hash = Hash(FindText(data, Tag(0x0010, 0x0020)), Hash(FindText(data, Tag(0x0010, 0x0010))));
  const std::string_view modality = FindText(data, Tag(0x0008, 0x0060));
  header.is_ct = modality == "CT" ? 1 : 0;
  std::string description(modality);
  if (const auto name = FindText(data, Tag(0x0008, 0x103E)); !name.empty())
    description += (description.empty() ? "" : ", ") + std::string(name);
  description.copy(header.description, sizeof(header.description) - 1);

  if (job.request.is_size_believed != 0) return;
  const std::uint64_t needed = header.SampleCount() / header.channels * pixel_bytes;
  if (structure.is_encapsulated) return;
  if (FindText(data, Tag(0x0028, 0x0004)) == "YBR_FULL_422")
    throw Failure{ErrorCode::kImageUnsupported,
                  "its colours are stored as YBR_FULL_422 without being packed, which is not read"};
  if (structure.pixel_bytes < needed) {
    throw Failure{ErrorCode::kImageTruncated, "its header announces " + std::to_string(needed) +
                                                  " bytes of pixels, and it holds " +
                                                  std::to_string(structure.pixel_bytes)};
  }
}

/// A header of each frame, one after the other, to where samples would go.
void ReadFrames(const Job& job, const DicomFile& file, const ImageHeader& header) {
  if (job.request.capacity / sizeof(ImageHeader) < header.depth)
    throw Failure{ErrorCode::kImageChanged, "it has more frames than before"};
  const gdcm::Tag per_frame(0x5200, 0x9230);
  if (file.Data().FindDataElement(per_frame)) {
    const auto items = file.Data().GetDataElement(per_frame).GetValueAsSQ();
    if (items == nullptr || items->GetNumberOfItems() < header.depth)
      throw Failure{ErrorCode::kImageUndecodable, "it describes fewer frames than it holds"};
  }
  for (std::uint32_t frame = 0; frame < header.depth; ++frame) {
    ImageHeader one = header;
    one.depth = 1;
    one.has_position = 0;
    ReadFrame(file.Data(), frame, header.depth, one);
    std::memcpy(job.samples + frame * sizeof(one), &one, sizeof(one));
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

/// Stored values that stand where the scanner has no image, as outside the round field of view.
struct Padding {
  int low = 0, high = 0;
};

/// Source: PS3.3 section C.7.5.1.1.2, Pixel Padding Value and Pixel Padding Range Limit.
std::optional<Padding> FindPadding(const gdcm::DataSet& data, SampleKind samples) {
  const auto find = [&](std::uint16_t element) -> std::optional<int> {
    const auto value = FindShort(data, Tag(0x0028, element));
    if (!value) return std::nullopt;
    return samples == SampleKind::kInt16 ? static_cast<std::int16_t>(*value) : static_cast<int>(*value);
  };
  const auto value = find(0x0120), limit = find(0x0121);
  if (!value) return std::nullopt;
  return Padding{std::min(*value, limit.value_or(*value)), std::max(*value, limit.value_or(*value))};
}

/// Which samples are in `is_padded` and hang together with the border of the frame through others that are.
void KeepAtBorder(std::uint32_t width, std::uint32_t height, std::vector<char>& is_padded) {
  std::vector<std::size_t> front;
  const auto reach = [&](std::size_t at) {
    if (is_padded[at] != 1) return;
    is_padded[at] = 2;
    front.push_back(at);
  };
  for (std::size_t x = 0; x < width; ++x) reach(x), reach((height - 1) * std::size_t{width} + x);
  for (std::size_t y = 0; y < height; ++y) reach(y * width), reach(y * width + width - 1);
  while (!front.empty()) {
    const std::size_t at = front.back(), x = at % width, y = at / width;
    front.pop_back();
    if (x > 0) reach(at - 1);
    if (x + 1 < width) reach(at + 1);
    if (y > 0) reach(at - width);
    if (y + 1 < height) reach(at + width);
  }
  for (char& state : is_padded) state = state == 2 ? 1 : 0;
}

/// Makes what is no image dark: in CT air, else the darkest that there is. A padding value that no other sample lies beyond is taken
/// wherever it stands; one from among them, as 0 in CT, only where it hangs together with the border: by some writers' mistake it is
/// a value of tissue, too.
template <typename Sample>
void DarkenPadding(const Padding& padding, const ImageHeader& header, Sample* samples) {
  constexpr double kAirHu = -1024;
  const std::size_t count = std::size_t{header.width} * header.height;
  std::vector<char> is_padded(count);
  int least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
  for (std::size_t i = 0; i < count; ++i) {
    const int value = samples[i];
    is_padded[i] = value >= padding.low && value <= padding.high ? 1 : 0;
    if (is_padded[i] != 0) continue;
    least = std::min(least, value), most = std::max(most, value);
  }
  const bool is_all = least > most;
  if (is_all && header.is_ct == 0) return;
  if (!is_all && least < padding.low && most > padding.high)
    KeepAtBorder(header.width, header.height, is_padded);
  const double dark = header.is_ct != 0 ? (kAirHu - header.intercept) / header.slope
                      : (header.is_inverted != 0) != (header.slope < 0) ? most
                                                                        : least;
  const auto filling = base::RoundTo<Sample>(std::clamp(dark, double{std::numeric_limits<Sample>::min()},
                                                        double{std::numeric_limits<Sample>::max()}));
  for (std::size_t i = 0; i < count; ++i) {
    if (is_padded[i] != 0) samples[i] = filling;
  }
}

void DarkenPadding(const Job& job, const DicomFile& file, const ImageHeader& header) {
  const auto padding = FindPadding(file.Data(), header.samples);
  if (!padding || header.channels != 1) return;
  const std::size_t frame_bytes = std::size_t{header.width} * header.height * SampleBytes(header.samples);
  for (std::uint32_t frame = 0; frame < header.depth; ++frame) {
    ImageHeader one = header;
    if (header.depth > 1) {
      FrameElements elements(file.Data(), frame);
      ReadGreyValues(elements, one);
    }
    std::byte* const samples = job.samples + frame * frame_bytes;
    if (header.samples == SampleKind::kUint8)
      DarkenPadding(*padding, one, reinterpret_cast<std::uint8_t*>(samples));
    else if (header.samples == SampleKind::kInt16)
      DarkenPadding(*padding, one, reinterpret_cast<std::int16_t*>(samples));
    else
      DarkenPadding(*padding, one, reinterpret_cast<std::uint16_t*>(samples));
  }
}

void ReadPixels(const Job& job, const DicomFile& file, const ImageHeader& header) {
  const auto stream = file.Open(job);
  PixelReader reader;
  reader.SetStream(*stream);
  if (!reader.Read()) throw Failure{ErrorCode::kImageUndecodable, "its pixels are damaged or missing"};
  const gdcm::Image& image = reader.GetImage();
  const std::size_t sample_bytes = image.GetPixelFormat().GetBitsAllocated() / 8;
  const auto shown = image.GetPhotometricInterpretation();  // after decoding
  const std::uint64_t expected = header.SampleCount() * sample_bytes / (reader.HasPalette() ? 3 : 1);
  const unsigned depth = image.GetNumberOfDimensions() == 3 ? image.GetDimension(2) : 1;
  if (depth != header.depth || image.GetDimension(0) != header.width ||
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
    const std::uint64_t plane = std::uint64_t{header.width} * header.height;
    const bool is_planar = image.GetPlanarConfiguration() == 1;
    for (std::uint64_t i = 0; i < plane * header.depth; ++i) {
      const std::uint64_t frame = i / plane, pixel = i % plane;
      for (std::uint64_t c = 0; c < 3; ++c)
        job.samples[3 * i + c] =
            static_cast<std::byte>(raw[is_planar ? (3 * frame + c) * plane + pixel : 3 * i + c]);
    }
    if (shown != gdcm::PhotometricInterpretation::YBR_FULL &&
        shown != gdcm::PhotometricInterpretation::YBR_FULL_422)
      return;
    for (std::byte* p = job.samples; p != job.samples + expected; p += 3) {
      const auto color =
          ToRgb(std::to_integer<int>(p[0]), std::to_integer<int>(p[1]), std::to_integer<int>(p[2]));
      for (std::size_t c = 0; c < 3; ++c) p[c] = static_cast<std::byte>(color[c]);
    }
    return;
  }
  if (sample_bytes == SampleBytes(header.samples)) {
    std::memcpy(job.samples, raw.data(), raw.size());
  } else {
    for (std::size_t i = 0; i < raw.size(); ++i) {  // signed bytes
      const auto value = static_cast<std::int16_t>(static_cast<signed char>(raw[i]));
      std::memcpy(job.samples + 2 * i, &value, 2);
    }
  }
  DarkenPadding(job, file, header);
}

}  // namespace

void ReadDicom(const Job& job, ImportReply& reply) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  reply.header.kind = FileKind::kDicom;
  const DicomFile file(job, reply.header);
  ReadHeader(job, file, reply.header);
  if (job.request.operation == ImportOperation::kProbeFrames)
    ReadFrames(job, file, reply.header);
  else if (job.samples != nullptr)
    ReadPixels(job, file, reply.header);
}

}  // namespace trocar::images::import
