// SPDX-License-Identifier: Apache-2.0
// Source: MetaIO documentation (itk.org/Wiki/MetaIO/Documentation); where that leaves something open, what MetaIO itself
// (metaObject.cxx, metaImage.cxx of github.com/Kitware/MetaIO) and ITK's itkMetaImageIO.cxx make of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

constexpr std::pair<const char*, StoredType> kTypes[] = {
    {"met_char", StoredType::kInt8},         {"met_ascii_char", StoredType::kInt8},
    {"met_uchar", StoredType::kUint8},       {"met_short", StoredType::kInt16},
    {"met_ushort", StoredType::kUint16},     {"met_int", StoredType::kInt32},
    {"met_uint", StoredType::kUint32},       {"met_long", StoredType::kInt32},
    {"met_ulong", StoredType::kUint32},      {"met_long_long", StoredType::kInt64},
    {"met_ulong_long", StoredType::kUint64}, {"met_float", StoredType::kFloat32},
    {"met_double", StoredType::kFloat64}};

/// The fields by lower-case name, the lines that follow the last one, and where the samples begin when they follow.
struct Fields {
  std::map<std::string, std::string, std::less<>> values;
  std::vector<std::string> list;  // of data files
  std::uint64_t end = 0;

  const std::string* Find(const std::string& name) const {
    const auto found = values.find(LowerCase(name));
    return found != values.end() ? &found->second : nullptr;
  }
  const std::string& Need(const char* name) const {
    const std::string* value = Find(name);
    if (value == nullptr)
      throw Failure{ErrorCode::kImageUndecodable, std::string("its header lacks ") + name};
    return *value;
  }
  /// As MetaIO reads it: by the first letter.
  bool IsTrue(const std::string& name) const {
    const std::string* value = Find(name);
    return value != nullptr && !value->empty() &&
           std::string_view("Tt1").find(value->front()) != std::string_view::npos;
  }
};

Fields ParseFields(const std::string& text, bool is_whole) {
  Fields fields;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    at = std::min(end + 1, text.size());
    const std::size_t separator = line.find_first_of("=:");
    if (separator == std::string_view::npos) {
      if (Trimmed(line).empty()) continue;
      if (end == text.size()) break;
      throw Failure{ErrorCode::kImageUndecodable, "a line of its header is no field"};
    }
    const std::string_view written = Trimmed(line.substr(0, separator));
    const std::string name = LowerCase(written);
    const bool is_new = fields.values.emplace(name, Trimmed(line.substr(separator + 1))).second;
    // two answers to one question: programs would differ in which they take
    if (!is_new && name != "comment")
      throw Failure{ErrorCode::kImageUndecodable, "its header has the field " + Shown(written) + " twice"};
    if (name != "elementdatafile") continue;
    fields.end = at;
    if (fields.values[name].starts_with("LIST")) {
      for (const std::string_view file : Words(std::string_view(text).substr(at), "\r\n")) {
        if (!Trimmed(file).empty()) fields.list.emplace_back(Trimmed(file));
      }
    }
    return fields;
  }
  if (!is_whole && at >= text.size()) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its header is longer than " + std::to_string(kLongestHeader >> 10) + " KiB"};
  }
  throw Failure{ErrorCode::kImageTruncated, "its header ends before the field ElementDataFile"};
}

/// The numbers of a field that goes by several names; those that are there must agree.
///
/// \param count  how many there must be at least
/// \return empty where there is no such field
std::vector<double> FindNumbers(const Fields& fields, std::initializer_list<const char*> names,
                                std::size_t count) {
  std::vector<double> numbers;
  const char* first = nullptr;
  for (const char* name : names) {
    const std::string* text = fields.Find(name);
    if (text == nullptr) continue;
    std::vector<double> values = ParseNumbers(*text, name);
    if (values.size() < count)
      throw Failure{ErrorCode::kImageUndecodable, std::string(name) + " has too few numbers"};
    if (first != nullptr && values != numbers) {
      throw Failure{ErrorCode::kImageUndecodable,
                    std::string(first) + " and " + name + " of its header do not agree"};
    }
    first = name;
    numbers = std::move(values);
  }
  return numbers;
}

double ReadUnitMm(const Fields& fields) {
  const std::string* unit = fields.Find("DistanceUnits");
  return unit == nullptr ? 1.0 : ParseUnitMm(*unit).value_or(1.0);
}

/// \param dimensions  of the header; directions and places of a fourth one have no part in space
void ReadFrame(const Fields& fields, std::size_t dimensions, ImageHeader& header) {
  const double unit_mm = ReadUnitMm(fields);
  const bool has_spacing = fields.Find("ElementSpacing") != nullptr;
  const char* const spacing_name = has_spacing ? "ElementSpacing" : "ElementSize";
  const auto spacing = FindNumbers(fields, {spacing_name}, dimensions);
  const std::size_t axes = std::min<std::size_t>(dimensions, 3);
  for (std::size_t axis = 0; axis < std::min(spacing.size(), axes); ++axis) {
    header.spacing[axis] = unit_mm * spacing[axis];
    if (!(spacing[axis] > 0)) {
      throw Failure{ErrorCode::kImageGeometryInvalid,
                    std::string(spacing_name) + " of its header is not greater than 0"};
    }
  }
  // since version 1 of the format the image's own frame has names of its own
  const std::string* version = fields.Find("FileFormatVersion");
  const bool is_newer =
      version != nullptr && ParseWhole(*version, "FileFormatVersion") > 0 &&
      (fields.Find("ElementDirection") != nullptr || fields.Find("ElementOrigin") != nullptr);
  const std::size_t count = dimensions * dimensions;
  const auto matrix = is_newer ? FindNumbers(fields, {"ElementDirection"}, count)
                               : FindNumbers(fields, {"TransformMatrix", "Rotation", "Orientation"}, count);
  const auto origin = is_newer ? FindNumbers(fields, {"ElementOrigin"}, dimensions)
                               : FindNumbers(fields, {"Offset", "Position", "Origin"}, dimensions);
  if (matrix.size() > count) {
    throw Failure{ErrorCode::kImageUndecodable, "the matrix of its directions has " +
                                                    std::to_string(matrix.size()) + " numbers where " +
                                                    std::to_string(count) + " belong"};
  }
  if (dimensions < 3 || matrix.empty()) return;
  header.frame = FileFrame::kLps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double square = 0;
    for (std::size_t k = 0; k < dimensions; ++k) {
      const double part = matrix[dimensions * axis + k];
      if (k >= 3 && part != 0)
        throw Failure{ErrorCode::kImageGeometryInvalid,
                      "one of its directions leads out of the body's space"};
      square += part * part;
    }
    const double length = std::sqrt(square);
    if (length == 0) throw Failure{ErrorCode::kImageGeometryInvalid, "one of its directions has no length"};
    // as everywhere, a step is the direction times the spacing, and not every writer's directions are unit vectors
    constexpr double kUnit = 1e-4;
    if (std::fabs(length - 1) > kUnit) header.spacing[axis] *= length;
    for (std::size_t k = 0; k < 3; ++k) header.direction[axis][k] = matrix[dimensions * axis + k] / length;
    if (!origin.empty()) header.origin[axis] = unit_mm * origin[axis];
  }
}

/// The name of the one data file; nothing where the samples follow the header.
std::optional<std::string> FindDataName(const Fields& fields) {
  const std::string& place = *fields.Find("ElementDataFile");
  if (place == "LOCAL" || place == "Local" || place == "local") return std::nullopt;
  const auto words = Words(place, " \t");
  const bool is_list = !words.empty() && words[0] == "LIST" && words.size() <= 2;
  if (is_list && fields.list.empty())
    throw Failure{ErrorCode::kImageTruncated, "it ends before the list of its data files"};
  if (is_list && fields.list.size() == 1) return fields.list[0];
  if (is_list || place.find('%') != std::string::npos)
    throw Failure{ErrorCode::kImageUnsupported, "its samples are in several files"};
  return place;
}

}  // namespace

void ReadMetaImage(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kMetaImage;
  const Fields fields = ParseFields(ReadBegin(job.file, kLongestHeader), job.file.bytes <= kLongestHeader);
  const std::int64_t dimensions = ParseWhole(fields.Need("NDims"), "NDims");
  std::vector<std::int64_t> sides;
  for (const auto word : Words(fields.Need("DimSize"))) sides.push_back(ParseWhole(word, "DimSize"));
  constexpr std::int64_t kMostDimensions = 10;  // MetaIO's
  if (dimensions < 2 || dimensions > kMostDimensions)
    throw Failure{ErrorCode::kImageUnsupported,
                  "its NDims is not between 2 and " + std::to_string(kMostDimensions)};
  if (sides.size() != static_cast<std::size_t>(dimensions))
    throw Failure{ErrorCode::kImageUndecodable, "NDims and DimSize of its header do not agree"};
  SetSides(sides, job, header);

  StoredSamples stored;
  const std::string& written = fields.Need("ElementType");
  std::string type = LowerCase(written);
  if (constexpr std::string_view kArray = "_array"; type.ends_with(kArray))
    type.resize(type.size() - kArray.size());
  bool is_known = false;
  for (const auto& [name, stored_type] : kTypes) {
    if (type == name) stored.type = stored_type, is_known = true;
  }
  if (!is_known)
    throw Failure{ErrorCode::kImageUnsupported, "its ElementType " + Shown(written) + " is not read"};
  const std::string* channels = fields.Find("ElementNumberOfChannels");
  const std::int64_t channel_count =
      channels == nullptr ? 1 : ParseWhole(*channels, "ElementNumberOfChannels");
  if (channel_count != 1 && !(channel_count == 3 && stored.type == StoredType::kUint8)) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "it has " + std::to_string(channel_count) +
                      " values a voxel; one, or three of 8 bits as colours, are read"};
  }
  header.channels = static_cast<std::uint32_t>(channel_count);
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));
  stored.is_big_endian = StoredBytes(stored.type) > 1 &&
                         (fields.IsTrue("ElementByteOrderMSB") || fields.IsTrue("BinaryDataByteOrderMSB"));
  if (fields.Find("BinaryData") != nullptr && !fields.IsTrue("BinaryData"))
    stored.packing = Packing::kText;
  else if (fields.IsTrue("CompressedData"))
    stored.packing = Packing::kDeflated;
  // MetaIO keeps these and ITK passes over them, so that programs show different grey values and convert them so
  const auto slope = FindNumbers(fields, {"ElementToIntensityFunctionSlope"}, 1),
             offset = FindNumbers(fields, {"ElementToIntensityFunctionOffset"}, 1);
  if ((!slope.empty() && slope[0] != 1) || (!offset.empty() && offset[0] != 0)) {
    throw Failure{ErrorCode::kImageGeometryInvalid,
                  "its ElementToIntensityFunction is applied by some programs and not by others"};
  }
  ReadFrame(fields, static_cast<std::size_t>(dimensions), header);
  CheckGeometry(header);
  CheckSize(header, job.request);

  const std::optional<std::string> name = FindDataName(fields);
  if (name && !FindDataFile(job, *name, header)) return;
  const InputFile& file = name ? *job.data_file : job.file;
  stored.begin = name ? 0 : fields.end;
  if (const std::string* skipped = fields.Find("HeaderSize"); skipped != nullptr) {
    const std::int64_t bytes = ParseWhole(*skipped, "HeaderSize");
    if (bytes < -1) throw Failure{ErrorCode::kImageUndecodable, "HeaderSize of its header is less than -1"};
    if (bytes == -1 && stored.packing != Packing::kPlain) {
      throw Failure{
          ErrorCode::kImageUnsupported,
          "its samples are to be found from the end of the file on (HeaderSize -1) and are packed or text"};
    }
    const std::uint64_t needed = BytesOfSamples(header, stored);
    if (bytes == -1) stored.begin = file.bytes - std::min(needed, file.bytes);
    if (bytes > 0) stored.begin = static_cast<std::uint64_t>(bytes);
  }
  CheckBytesPresent(header, stored, file, job.request);
  if (job.samples != nullptr) ReadSamples(header, stored, file, job.samples);
}

}  // namespace trocar::images::import
