// SPDX-License-Identifier: Apache-2.0
// Source: MetaIO documentation (itk.org/Wiki/MetaIO/Documentation).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using core::ErrorCode;

constexpr std::pair<const char*, StoredType> kTypes[] = {
    {"met_char", StoredType::kInt8},        {"met_uchar", StoredType::kUint8},
    {"met_short", StoredType::kInt16},      {"met_ushort", StoredType::kUint16},
    {"met_int", StoredType::kInt32},        {"met_uint", StoredType::kUint32},
    {"met_long_long", StoredType::kInt64},  {"met_ulong_long", StoredType::kUint64},
    {"met_float", StoredType::kFloat32},    {"met_double", StoredType::kFloat64},
    {"met_uchar_array", StoredType::kUint8}};

/// The fields by lower-case name, and where the samples begin when they follow.
struct Fields {
  std::map<std::string, std::string, std::less<>> values;
  std::uint64_t end = 0;

  const std::string* Find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const auto found = values.find(name); found != values.end()) return &found->second;
    }
    return nullptr;
  }
  bool IsTrue(std::initializer_list<const char*> names) const {
    const std::string* value = Find(names);
    return value != nullptr && LowerCase(*value) == "true";
  }
};

Fields ParseFields(const std::string& text) {
  Fields fields;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;
    const std::string_view line = std::string_view(text).substr(at, end - at);
    at = end + 1;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      if (Trimmed(line).empty()) continue;
      break;
    }
    const std::string name = LowerCase(Trimmed(line.substr(0, equals)));
    const bool is_new = fields.values.emplace(name, Trimmed(line.substr(equals + 1))).second;
    // two answers to one question: programs would differ in which they take
    if (!is_new && name != "comment")
      throw Failure{ErrorCode::kImageUndecodable, "its header has a field twice"};
    if (name == "elementdatafile") {
      fields.end = at;
      return fields;
    }
  }
  throw Failure{ErrorCode::kImageTruncated, "its header ends before the field ElementDataFile"};
}

void ReadFrame(const Fields& fields, ImageHeader& header) {
  const std::size_t dimensions = header.depth > 1 || fields.Find({"ndims"})->starts_with('3') ? 3 : 2;
  const auto numbers = [&](std::initializer_list<const char*> names, std::size_t count) {
    const std::string* text = fields.Find(names);
    std::vector<double> values =
        text == nullptr ? std::vector<double>{} : ParseNumbers(*text, *names.begin());
    if (text != nullptr && values.size() < count)
      throw Failure{ErrorCode::kImageUndecodable, std::string(*names.begin()) + " has too few numbers"};
    return values;
  };
  const auto spacing = numbers({"elementspacing", "elementsize"}, dimensions);
  for (std::size_t axis = 0; axis < std::min(spacing.size(), dimensions); ++axis) {
    header.spacing[axis] = spacing[axis];
    if (!(spacing[axis] > 0))
      throw Failure{ErrorCode::kImageGeometryInvalid, "ElementSpacing is not greater than 0"};
  }
  if (dimensions != 3) return;
  const auto matrix = numbers({"transformmatrix", "rotation", "orientation"}, 9);
  const auto origin = numbers({"offset", "position", "origin"}, 3);
  if (matrix.empty()) return;
  header.frame = FileFrame::kLps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k) length += matrix[3 * axis + k] * matrix[3 * axis + k];
    for (std::size_t k = 0; k < 3; ++k) header.direction[axis][k] = matrix[3 * axis + k] / std::sqrt(length);
    if (!origin.empty()) header.origin[axis] = origin[axis];
  }
}

}  // namespace

void ReadMetaImage(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kMetaImage;
  const Fields fields = ParseFields(ReadBegin(job.file, kLongestHeader));
  const auto need = [&](std::initializer_list<const char*> names, const char* written) {
    const std::string* value = fields.Find(names);
    if (value == nullptr)
      throw Failure{ErrorCode::kImageUndecodable, std::string("its header lacks ") + written};
    return value;
  };
  const std::int64_t dimensions = ParseWhole(*need({"ndims"}, "NDims"), "NDims");
  std::vector<std::int64_t> sides;
  for (const auto word : Words(*need({"dimsize"}, "DimSize"))) sides.push_back(ParseWhole(word, "DimSize"));
  if (dimensions < 2 || dimensions > 4 || sides.size() != static_cast<std::size_t>(dimensions))
    throw Failure{ErrorCode::kImageUndecodable, "NDims and DimSize of its header do not agree"};
  SetSides(sides, job, header);

  StoredSamples stored;
  const std::string type = LowerCase(*need({"elementtype"}, "ElementType"));
  bool is_known = false;
  for (const auto& [name, stored_type] : kTypes) {
    if (type == name) stored.type = stored_type, is_known = true;
  }
  if (!is_known) throw Failure{ErrorCode::kImageUnsupported, "its ElementType is not read"};
  const std::string* channels = fields.Find({"elementnumberofchannels"});
  const std::int64_t channel_count =
      channels == nullptr ? 1 : ParseWhole(*channels, "ElementNumberOfChannels");
  if (channel_count != 1 && !(channel_count == 3 && stored.type == StoredType::kUint8))
    throw Failure{ErrorCode::kImageUnsupported, "it has neither grey values nor three channels of 8 bits"};
  header.channels = static_cast<std::uint32_t>(channel_count);
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));
  stored.is_big_endian =
      StoredBytes(stored.type) > 1 && fields.IsTrue({"elementbyteordermsb", "binarydatabyteordermsb"});
  stored.is_deflated = fields.IsTrue({"compresseddata"});
  const std::string* binary = fields.Find({"binarydata"});
  if (binary != nullptr && LowerCase(*binary) == "false")
    throw Failure{ErrorCode::kImageUnsupported, "its samples are written as text"};
  ReadFrame(fields, header);
  CheckGeometry(header);
  CheckSize(header, job.request);

  const std::string& place = *fields.Find({"elementdatafile"});
  const std::string lower = LowerCase(place);
  if (lower.starts_with("list"))
    throw Failure{ErrorCode::kImageUnsupported, "its samples are spread over several files"};
  const bool is_local = lower == "local";
  if (!is_local && !FindDataFile(job, place, header)) return;
  const InputFile& file = is_local ? job.file : *job.data_file;
  stored.begin = is_local ? fields.end : 0;
  if (const std::string* skipped = fields.Find({"headersize"}); skipped != nullptr && !is_local) {
    const std::int64_t bytes = ParseWhole(*skipped, "HeaderSize");
    if (bytes < -1) throw Failure{ErrorCode::kImageUndecodable, "HeaderSize is negative"};
    const std::uint64_t needed = CheckedProduct({header.SampleCount(), StoredBytes(stored.type)});
    stored.begin = bytes >= 0 ? static_cast<std::uint64_t>(bytes) : file.bytes - std::min(needed, file.bytes);
  }
  CheckBytesPresent(header, stored, file, job.request);
  if (job.samples != nullptr) ReadSamples(header, stored, file, job.samples);
}

}  // namespace trocar::images::import
