// SPDX-License-Identifier: Apache-2.0
// Source: NIfTI-1 and NIfTI-2 data format, nifti1.h and nifti2.h (method 1 to 3 of orientation). Where files depart from it,
// what nifti_clib (nifti1_io.c) and nibabel (nifti1.py) make of them is taken.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"
#include "trocar/base/to_integer.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

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

/// Orientation, steps and place as one of the two ways of the header says them.
struct Frame {
  Matrix direction{};
  std::array<double, 3> spacing{}, origin{};
};

/// \return why it is of no use; nothing where it is
std::optional<Failure> ReadSform(const Fields& fields, const Layout& layout, double unit_mm, Frame& frame) {
  const std::size_t number = layout.is_second ? 8 : 4;
  for (int world = 0; world < 3; ++world) {
    for (int axis = 0; axis < 3; ++axis)
      frame.direction[world][axis] = unit_mm * fields.Length(layout.rows + 4 * world * number, axis);
    frame.origin[world] = unit_mm * fields.Length(layout.rows + 4 * world * number, 3);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double x = frame.direction[0][axis], y = frame.direction[1][axis], z = frame.direction[2][axis];
    frame.spacing[axis] = std::sqrt(x * x + y * y + z * z);
    if (frame.spacing[axis] == 0)
      return Failure{ErrorCode::kImageGeometryInvalid, "its sform has an axis without length"};
    if (!std::isfinite(frame.spacing[axis]))
      return Failure{ErrorCode::kImageGeometryInvalid, "its sform has an axis that is not a finite number"};
    for (int world = 0; world < 3; ++world) frame.direction[world][axis] /= frame.spacing[axis];
  }
  return std::nullopt;
}

/// \return why it is of no use; nothing where it is
std::optional<Failure> ReadQform(const Fields& fields, const Layout& layout, double unit_mm, Frame& frame) {
  constexpr double kRounding = 1e-3;  // of a quaternion in single precision, written by anybody
  double b = fields.Length(layout.quaternion, 0), c = fields.Length(layout.quaternion, 1),
         d = fields.Length(layout.quaternion, 2);
  const double square = b * b + c * c + d * d;
  if (!(square <= 1 + kRounding))
    return Failure{ErrorCode::kImageGeometryInvalid, "its qform is no rotation"};
  const double a = std::sqrt(std::max(0.0, 1.0 - square));
  if (square > 1) b /= std::sqrt(square), c /= std::sqrt(square), d /= std::sqrt(square);
  frame.direction = {{{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
                      {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
                      {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}}};
  const bool is_mirrored = fields.Length(layout.pixel_dimensions, 0) < 0;
  for (int world = 0; world < 3; ++world) {
    if (is_mirrored) frame.direction[world][2] = -frame.direction[world][2];
    frame.origin[world] = unit_mm * fields.Length(layout.quaternion_offset, world);
  }
  for (int axis = 0; axis < 3; ++axis)
    frame.spacing[axis] = unit_mm * std::fabs(fields.Length(layout.pixel_dimensions, 1 + axis));
  return std::nullopt;
}

/// Orientation and place, RAS in the file, LPS in the header: by the sform, else by the qform.
void ReadFrame(const Fields& fields, const Layout& layout, double unit_mm, ImageHeader& header) {
  const bool has_sform = fields.Code(layout.sform) > 0, has_qform = fields.Code(layout.qform) > 0;
  Frame frame;
  std::optional<Failure> fault;
  if (has_sform) fault = ReadSform(fields, layout, unit_mm, frame);
  if (fault && !has_qform) throw *fault;
  if (has_qform && (!has_sform || fault)) {
    const std::optional<Failure> other = ReadQform(fields, layout, unit_mm, frame);
    if (other && fault)
      throw Failure{ErrorCode::kImageGeometryInvalid, fault->why + ", and its qform is no rotation"};
    if (other) throw *other;
  }
  if (!has_sform && !has_qform) {
    for (int axis = 0; axis < 3; ++axis)
      header.spacing[axis] = unit_mm * std::fabs(fields.Length(layout.pixel_dimensions, 1 + axis));
    return;
  }
  header.frame = FileFrame::kRas;
  for (int axis = 0; axis < 3; ++axis) header.spacing[axis] = frame.spacing[axis];
  for (int world = 0; world < 3; ++world) {
    const double sign = world == 2 ? 1.0 : -1.0;
    for (int axis = 0; axis < 3; ++axis) header.direction[axis][world] = sign * frame.direction[world][axis];
    header.origin[world] = sign * frame.origin[world];
  }
}

/// Length of the header's unit [mm]; millimetres where it says none.
double ReadUnitMm(int code) {
  switch (code & 7) {
    case 0:
    case 2:
      return 1.0;
    case 1:
      return 1000.0;
    case 3:
      return 0.001;
    default:
      throw Failure{ErrorCode::kImageGeometryInvalid, "its unit of length has the code " +
                                                          std::to_string(code & 7) +
                                                          ", which NIfTI does not know (1 to 3)"};
  }
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

/// Sides of a volume; trailing dimensions of 0 or less count as 1, as everywhere.
void ReadSides(const Fields& fields, const Layout& layout, const Job& job, ImageHeader& header) {
  const std::int64_t dimensions = fields.Count(layout.dimensions, 0);
  if (dimensions < 1 || dimensions > 7)
    throw Failure{ErrorCode::kImageUndecodable, "its number of dimensions is not between 1 and 7"};
  std::vector<std::int64_t> sides;
  for (std::size_t i = 1; i <= static_cast<std::size_t>(dimensions); ++i) {
    const std::int64_t side = fields.Count(layout.dimensions, i);
    sides.push_back(i > 3 ? std::max<std::int64_t>(side, 1) : side);
  }
  if (sides.size() > 4 && sides[3] == 1 && sides[4] != 1) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "it has " + std::to_string(sides[4]) + " values a voxel; extract one of them"};
  }
  SetSides(sides, job, header);
}

/// What a voxel type that is not read is called.
std::string NameOfType(int code) {
  switch (code) {
    case 0:
      return "0 (not said)";
    case 1:
      return "1 (single bits)";
    case 32:
    case 1792:
    case 2048:
      return std::to_string(code) + " (complex numbers)";
    case 1536:
      return "1536 (floating point of 128 bits)";
    case 2304:
      return "2304 (colour with transparency)";
    default:
      return std::to_string(code);
  }
}

/// Where the voxels begin in the unpacked file.
std::uint64_t FindVoxels(double begin, const Layout& layout, const InputFile& file,
                         std::uint64_t bytes_of_samples) {
  if (begin == 0) {
    // programs differ in whether the voxels follow the header at once: the length of the file tells
    const std::uint64_t without = layout.header_bytes + bytes_of_samples,
                        all = CountUnpacked(file, without + 5);
    if (all == without) return layout.header_bytes;
    if (all == without + 4) return layout.header_bytes + 4;
    throw Failure{ErrorCode::kImageUndecodable,
                  "it does not say where its voxels begin (vox_offset), nor does its length tell"};
  }
  if (!(begin >= static_cast<double>(layout.header_bytes) && begin < 1e15) || begin != std::floor(begin)) {
    throw Failure{ErrorCode::kImageUndecodable,
                  "where its voxels begin (vox_offset) is no place behind its header"};
  }
  return base::TruncateTo<std::uint64_t>(begin);
}

/// Where they begin in the .img of a pair.
std::uint64_t FindVoxelsOfPair(double begin) {
  if (!(begin >= 0 && begin < 1e15) || begin != std::floor(begin))
    throw Failure{ErrorCode::kImageUndecodable, "where its voxels begin (vox_offset) is no place in a file"};
  return base::TruncateTo<std::uint64_t>(begin);
}

}  // namespace

bool IsAnalyze(std::string_view begin) {
  constexpr std::int32_t kAnalyzeBytes = 348;
  constexpr std::size_t kDimensions = 40;
  if (begin.size() < kDimensions + 2) return false;
  for (const bool is_swapped : {false, true}) {
    const std::string bytes(begin);
    const Fields fields(bytes, kFirst, is_swapped);
    const auto dimensions = fields.At<std::int16_t>(kDimensions);
    if (fields.At<std::int32_t>(0) == kAnalyzeBytes && dimensions >= 1 && dimensions <= 7) return true;
  }
  return false;
}

void ReadNifti(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kNifti;
  const std::string bytes = ReadUnpacked(job.file, kSecond.header_bytes);
  const std::string mark = bytes.size() >= 8 ? bytes.substr(4, 3) : "";
  const bool is_second = mark == "n+2" || mark == "ni2";
  const Layout& layout = is_second ? kSecond : kFirst;
  if (bytes.size() < layout.header_bytes)
    throw Failure{ErrorCode::kImageTruncated, "it ends within its header"};
  const bool is_pair = bytes.compare(is_second ? 4 : 344, 2, "ni") == 0;
  bool is_swapped = false;
  const auto header_bytes = static_cast<std::int32_t>(layout.header_bytes);
  if (Fields(bytes, layout, false).At<std::int32_t>(0) != header_bytes) {
    is_swapped = true;
    if (Fields(bytes, layout, true).At<std::int32_t>(0) != header_bytes)
      throw Failure{ErrorCode::kImageUndecodable, "the size of its NIfTI header is wrong"};
  }
  const Fields fields(bytes, layout, is_swapped);
  ReadSides(fields, layout, job, header);

  const int code = fields.At<std::int16_t>(layout.data_type);
  const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                  [&](const TypeCode& entry) { return entry.code == code; });
  if (type == std::end(kTypes))
    throw Failure{ErrorCode::kImageUnsupported, "its voxel type " + NameOfType(code) + " is not read"};
  StoredSamples stored;
  stored.type = type->type;
  stored.is_big_endian = is_swapped;
  header.channels = code == kColour ? 3 : 1;
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));

  // a slope of 0 or that is no number says that there is none
  const double slope = fields.Length(layout.slope);
  if (slope != 0 && std::isfinite(slope))
    header.slope = slope, header.intercept = fields.Length(layout.intercept);
  ReadFrame(fields, layout,
            ReadUnitMm(is_second ? fields.At<std::int32_t>(layout.units) : bytes[layout.units]), header);
  CheckGeometry(header);
  CheckSize(header, job.request);

  const double begin =
      is_second ? static_cast<double>(fields.At<std::int64_t>(layout.begin)) : fields.At<float>(layout.begin);
  std::uint64_t end_of_extensions = kLongestHeader;
  if (is_pair) {
    stored.skipped = FindVoxelsOfPair(begin);
  } else {
    stored.skipped = FindVoxels(begin, layout, job.file, BytesOfSamples(header, stored));
    end_of_extensions = std::min<std::uint64_t>(stored.skipped, kLongestHeader);
  }
  if (end_of_extensions > layout.header_bytes + 4)
    ReadExtensions(ReadUnpacked(job.file, end_of_extensions), layout, is_swapped, reply);
  if (is_pair && !job.data_file) {
    header.is_data_beside = 1;
    return;
  }
  const InputFile& file = is_pair ? *job.data_file : job.file;
  if (IsGzip(file))
    stored.packing = Packing::kDeflated;
  else
    std::swap(stored.begin, stored.skipped);
  CheckBytesPresent(header, stored, file, job.request);
  if (job.samples != nullptr) ReadSamples(header, stored, file, job.samples);
}

}  // namespace trocar::images::import
