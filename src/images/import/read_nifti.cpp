// SPDX-License-Identifier: Apache-2.0
// Source: NIfTI-1 and NIfTI-2 data format, nifti1.h and nifti2.h (method 1 to 3 of orientation).
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using core::ErrorCode;

/// Where the fields of either version stand.
struct Layout {
  std::size_t header_bytes, data_type, dimensions, pixel_dimensions, begin, slope, intercept, units, qform,
      sform, quaternion, quaternion_offset, rows;
  bool is_second;  // 64-bit counts, double lengths
};
constexpr Layout kFirst = {348, 70, 40, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280, false};
constexpr Layout kSecond = {540, 12, 16, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400, true};

class Fields {
 public:
  Fields(const std::string& bytes, const Layout& layout, bool is_swapped)
      : bytes_(bytes), layout_(layout), is_swapped_(is_swapped) {}

  template <typename Number>
  Number At(std::size_t offset) const {
    char raw[sizeof(Number)];
    std::memcpy(raw, bytes_.data() + offset, sizeof(raw));
    if (is_swapped_) std::reverse(raw, raw + sizeof(raw));
    Number number;
    std::memcpy(&number, raw, sizeof(raw));
    return number;
  }
  std::int64_t Count(std::size_t begin, std::size_t i) const {
    return layout_.is_second ? At<std::int64_t>(begin + 8 * i) : At<std::int16_t>(begin + 2 * i);
  }
  double Length(std::size_t begin, std::size_t i = 0) const {
    return layout_.is_second ? At<double>(begin + 8 * i) : At<float>(begin + 4 * i);
  }
  int Code(std::size_t offset) const {
    return layout_.is_second ? At<std::int32_t>(offset) : At<std::int16_t>(offset);
  }

 private:
  const std::string& bytes_;
  const Layout& layout_;
  bool is_swapped_;
};

struct TypeCode {
  int code;
  StoredType type;
};
constexpr TypeCode kTypes[] = {
    {2, StoredType::kUint8},    {4, StoredType::kInt16},    {8, StoredType::kInt32},
    {16, StoredType::kFloat32}, {64, StoredType::kFloat64}, {128, StoredType::kUint8},
    {256, StoredType::kInt8},   {512, StoredType::kUint16}, {768, StoredType::kUint32},
    {1024, StoredType::kInt64}, {1280, StoredType::kUint64}};
constexpr int kColour = 128;

using Matrix = std::array<std::array<double, 3>, 3>;  // [world, RAS][image axis]

Matrix FromQuaternion(double b, double c, double d) {
  const double a = std::sqrt(std::max(0.0, 1.0 - b * b - c * c - d * d));
  return {{{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
           {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
           {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}}};
}

/// Orientation and place, RAS in the file, LPS in the header.
void ReadFrame(const Fields& fields, const Layout& layout, double unit_mm, ImageHeader& header) {
  for (int axis = 0; axis < 3; ++axis)
    header.spacing[axis] = unit_mm * std::fabs(fields.Length(layout.pixel_dimensions, 1 + axis));
  Matrix matrix{};
  std::array<double, 3> origin{};
  if (fields.Code(layout.sform) > 0) {
    const std::size_t number = layout.is_second ? 8 : 4;
    for (int world = 0; world < 3; ++world) {
      for (int axis = 0; axis < 3; ++axis)
        matrix[world][axis] = unit_mm * fields.Length(layout.rows + 4 * world * number, axis);
      origin[world] = unit_mm * fields.Length(layout.rows + 4 * world * number, 3);
    }
    for (int axis = 0; axis < 3; ++axis) {
      header.spacing[axis] = std::sqrt(matrix[0][axis] * matrix[0][axis] + matrix[1][axis] * matrix[1][axis] +
                                       matrix[2][axis] * matrix[2][axis]);
      for (int world = 0; world < 3; ++world) matrix[world][axis] /= header.spacing[axis];
    }
  } else if (fields.Code(layout.qform) > 0) {
    matrix = FromQuaternion(fields.Length(layout.quaternion, 0), fields.Length(layout.quaternion, 1),
                            fields.Length(layout.quaternion, 2));
    const bool is_mirrored = fields.Length(layout.pixel_dimensions, 0) < 0;
    for (int world = 0; world < 3; ++world) {
      if (is_mirrored) matrix[world][2] = -matrix[world][2];
      origin[world] = unit_mm * fields.Length(layout.quaternion_offset, world);
    }
  } else {
    return;
  }
  header.frame = FileFrame::kRas;
  for (int world = 0; world < 3; ++world) {
    const double sign = world == 2 ? 1.0 : -1.0;
    for (int axis = 0; axis < 3; ++axis) header.direction[axis][world] = sign * matrix[world][axis];
    header.origin[world] = sign * origin[world];
  }
}

std::string ReadHeaderBytes(const InputFile& file, bool is_deflated,
                            std::size_t most = kSecond.header_bytes) {
  if (!is_deflated) return ReadBegin(file, most);
  std::string bytes(most, '\0');
  bytes.resize(OpenDeflated(file, 0)->Read(bytes.data(), bytes.size()));
  return bytes;
}

/// Text of an XML element after its start tag, without CDATA's brackets.
std::string_view ElementText(std::string_view xml) {
  constexpr std::string_view kOpen = "<![CDATA[";
  xml = Trimmed(xml);
  if (!xml.starts_with(kOpen)) return Trimmed(xml.substr(0, xml.find('<')));
  xml.remove_prefix(kOpen.size());
  return Trimmed(xml.substr(0, xml.find("]]>")));
}

/// Names of labels from a label table, <Label Key="5" ...><![CDATA[liver]]></Label>, which TotalSegmentator and
/// Connectome Workbench (Caret) put into an extension of the header. What is no such element is passed over:
/// extensions are anybody's.
void ReadLabelTable(std::string_view xml, ImportReply& reply) {
  constexpr std::string_view kElement = "<Label ", kKey = " Key=\"";
  while (reply.header.segments < kMostSegments) {
    const auto begin = xml.find(kElement);
    if (begin == std::string_view::npos) return;
    xml.remove_prefix(begin + kElement.size() - 1);
    const auto end = xml.find('>');
    if (end == std::string_view::npos) return;
    const std::string_view attributes = xml.substr(0, end);
    xml.remove_prefix(end + 1);
    const auto key = attributes.find(kKey);
    if (key == std::string_view::npos) continue;
    const std::string_view digits = attributes.substr(key + kKey.size());
    int label = 0;
    const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), label);
    const std::string_view name = ElementText(xml);
    if (parsed.ec != std::errc() || label < 1 || name.empty()) continue;
    SegmentName& entry = reply.names[reply.header.segments++];
    name.copy(entry.name, sizeof(entry.name) - 1);
    entry.label = label;
  }
}

/// Label tables among the extensions between the header and the voxels.
///
/// \param bytes  the file up to its voxels
void ReadExtensions(std::string_view bytes, const Layout& layout, bool is_swapped, ImportReply& reply) {
  std::size_t at = layout.header_bytes;
  if (bytes.size() < at + 4 || bytes[at] == 0) return;
  at += 4;
  constexpr std::size_t kOwnBytes = 8;  // size and code of an extension
  while (at + kOwnBytes <= bytes.size()) {
    char raw[4];
    bytes.copy(raw, sizeof(raw), at);
    if (is_swapped) std::reverse(raw, raw + sizeof(raw));
    std::int32_t size = 0;
    std::memcpy(&size, raw, sizeof(raw));
    if (size <= static_cast<std::int32_t>(kOwnBytes) || static_cast<std::size_t>(size) > bytes.size() - at)
      return;
    ReadLabelTable(bytes.substr(at + kOwnBytes, static_cast<std::size_t>(size) - kOwnBytes), reply);
    at += static_cast<std::size_t>(size);
  }
}

}  // namespace

void ReadNifti(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kNifti;
  const bool is_deflated = IsGzip(job.file);
  const std::string bytes = ReadHeaderBytes(job.file, is_deflated);
  const bool is_second = bytes.size() >= 8 && bytes.substr(4, 3) == "n+2";
  const Layout& layout = is_second ? kSecond : kFirst;
  if (bytes.size() < layout.header_bytes)
    throw Failure{ErrorCode::kImageTruncated, "it ends within its header"};
  if (!is_second && bytes.substr(344, 3) == "ni1") {
    throw Failure{ErrorCode::kImageUnsupported, "its samples are in a file of their own (.hdr and .img)"};
  }
  bool is_swapped = false;
  const auto header_bytes = static_cast<std::int32_t>(layout.header_bytes);
  if (Fields(bytes, layout, false).At<std::int32_t>(0) != header_bytes) {
    is_swapped = true;
    if (Fields(bytes, layout, true).At<std::int32_t>(0) != header_bytes)
      throw Failure{ErrorCode::kImageUndecodable, "the size of its NIfTI header is wrong"};
  }
  const Fields fields(bytes, layout, is_swapped);

  const std::int64_t dimensions = fields.Count(layout.dimensions, 0);
  if (dimensions < 1 || dimensions > 7)
    throw Failure{ErrorCode::kImageUndecodable, "its number of dimensions is not between 1 and 7"};
  std::uint64_t sides[7] = {1, 1, 1, 1, 1, 1, 1};
  for (int i = 0; i < dimensions; ++i) {
    const std::int64_t side = fields.Count(layout.dimensions, 1 + static_cast<std::size_t>(i));
    if (side < 1)
      throw Failure{ErrorCode::kImageUndecodable, "one of its sides has no voxel or a negative number"};
    sides[i] = static_cast<std::uint64_t>(side);
  }
  if (CheckedProduct({sides[3], sides[4], sides[5], sides[6]}) != 1)
    throw Failure{ErrorCode::kImageUnsupported, "it has more than three dimensions; extract one volume"};
  CheckedProduct({sides[0], sides[1], sides[2], 8});
  for (const std::uint64_t side : {sides[0], sides[1], sides[2]}) {
    if (side > job.request.most_side)
      throw Failure{ErrorCode::kImageTooLarge,
                    "one of its sides is longer than " + std::to_string(job.request.most_side) + " voxels"};
  }
  header.width = static_cast<std::uint32_t>(sides[0]);
  header.height = static_cast<std::uint32_t>(sides[1]);
  header.depth = static_cast<std::uint32_t>(sides[2]);

  const int code = fields.At<std::int16_t>(layout.data_type);
  const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                  [&](const TypeCode& entry) { return entry.code == code; });
  if (type == std::end(kTypes))
    throw Failure{ErrorCode::kImageUnsupported, "its voxel type " + std::to_string(code) + " is not read"};
  StoredSamples stored;
  stored.type = type->type;
  stored.is_big_endian = is_swapped;
  stored.is_whole_file_deflated = is_deflated;
  header.channels = code == kColour ? 3 : 1;
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));

  const double begin =
      is_second ? static_cast<double>(fields.At<std::int64_t>(layout.begin)) : fields.At<float>(layout.begin);
  if (!(begin >= static_cast<double>(layout.header_bytes) && begin < 1e15) || begin != std::floor(begin))
    throw Failure{ErrorCode::kImageUndecodable, "where its voxels begin (vox_offset) is no place in a file"};
  stored.begin = static_cast<std::uint64_t>(begin);
  const double slope = fields.Length(layout.slope);
  if (slope != 0) header.slope = slope, header.intercept = fields.Length(layout.intercept);

  const int units = (is_second ? fields.At<std::int32_t>(layout.units) : bytes[layout.units]) & 7;
  ReadFrame(fields, layout, units == 1 ? 1000.0 : units == 3 ? 0.001 : 1.0, header);
  CheckGeometry(header);
  CheckSize(header, job.request);
  CheckBytesPresent(header, stored, job.file, job.request);
  if (const auto most = std::min<std::uint64_t>(stored.begin, kLongestHeader); most > layout.header_bytes + 4)
    ReadExtensions(ReadHeaderBytes(job.file, is_deflated, most), layout, is_swapped, reply);
  if (job.samples != nullptr) ReadSamples(header, stored, job.file, job.samples);
}

}  // namespace trocar::images::import
