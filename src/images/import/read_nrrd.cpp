// SPDX-License-Identifier: Apache-2.0
// Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using core::ErrorCode;

constexpr std::pair<const char*, StoredType> kTypes[] = {{"signed char", StoredType::kInt8},
                                                         {"int8", StoredType::kInt8},
                                                         {"int8_t", StoredType::kInt8},
                                                         {"uchar", StoredType::kUint8},
                                                         {"unsigned char", StoredType::kUint8},
                                                         {"uint8", StoredType::kUint8},
                                                         {"uint8_t", StoredType::kUint8},
                                                         {"short", StoredType::kInt16},
                                                         {"short int", StoredType::kInt16},
                                                         {"signed short", StoredType::kInt16},
                                                         {"signed short int", StoredType::kInt16},
                                                         {"int16", StoredType::kInt16},
                                                         {"int16_t", StoredType::kInt16},
                                                         {"ushort", StoredType::kUint16},
                                                         {"unsigned short", StoredType::kUint16},
                                                         {"unsigned short int", StoredType::kUint16},
                                                         {"uint16", StoredType::kUint16},
                                                         {"uint16_t", StoredType::kUint16},
                                                         {"int", StoredType::kInt32},
                                                         {"signed int", StoredType::kInt32},
                                                         {"int32", StoredType::kInt32},
                                                         {"int32_t", StoredType::kInt32},
                                                         {"uint", StoredType::kUint32},
                                                         {"unsigned int", StoredType::kUint32},
                                                         {"uint32", StoredType::kUint32},
                                                         {"uint32_t", StoredType::kUint32},
                                                         {"longlong", StoredType::kInt64},
                                                         {"long long", StoredType::kInt64},
                                                         {"long long int", StoredType::kInt64},
                                                         {"signed long long", StoredType::kInt64},
                                                         {"signed long long int", StoredType::kInt64},
                                                         {"int64", StoredType::kInt64},
                                                         {"int64_t", StoredType::kInt64},
                                                         {"ulonglong", StoredType::kUint64},
                                                         {"unsigned long long", StoredType::kUint64},
                                                         {"unsigned long long int", StoredType::kUint64},
                                                         {"uint64", StoredType::kUint64},
                                                         {"uint64_t", StoredType::kUint64},
                                                         {"float", StoredType::kFloat32},
                                                         {"double", StoredType::kFloat64}};

/// Fields by lower-case name, key/value pairs as written, and where the header ends.
struct Fields {
  std::map<std::string, std::string, std::less<>> values;
  std::map<std::string, std::string, std::less<>> pairs;
  std::uint64_t end = 0;
  bool has_data = false;  // the blank line was there

  const std::string* Find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const auto found = values.find(name); found != values.end()) return &found->second;
    }
    return nullptr;
  }
  const std::string& Need(const char* name) const {
    const std::string* value = Find({name});
    if (value == nullptr)
      throw Failure{ErrorCode::kImageUndecodable, std::string("its header lacks ") + name};
    return *value;
  }
};

Fields ParseFields(const std::string& text) {
  Fields fields;
  std::size_t at = text.find('\n');
  at = at == std::string::npos ? text.size() : at + 1;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    at = end + 1;
    fields.end = std::min(at, text.size());
    if (line.empty() || line == "\r") {
      fields.has_data = true;
      return fields;
    }
    if (line.starts_with('#')) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      throw Failure{ErrorCode::kImageUndecodable, "a line of its header is neither field nor comment"};
    if (line.substr(colon, 2) == ":=") {
      fields.pairs.emplace(line.substr(0, colon), Trimmed(line.substr(colon + 2)));
      continue;
    }
    if (!fields.values.emplace(LowerCase(Trimmed(line.substr(0, colon))), Trimmed(line.substr(colon + 1)))
             .second)
      throw Failure{ErrorCode::kImageUndecodable, "its header has a field twice"};
  }
  return fields;
}

/// Signs that turn the file's axes into left, posterior, superior; none for a frame that is not the
/// patient's.
std::optional<std::array<double, 3>> FindFrame(const Fields& fields, FileFrame& frame) {
  const std::string* space = fields.Find({"space"});
  if (space == nullptr) return std::nullopt;
  const std::string name = LowerCase(*space);
  if (name == "left-posterior-superior" || name == "lps") {
    frame = FileFrame::kLps;
    return std::array{1.0, 1.0, 1.0};
  }
  if (name == "right-anterior-superior" || name == "ras") {
    frame = FileFrame::kRas;
    return std::array{-1.0, -1.0, 1.0};
  }
  if (name == "left-anterior-superior" || name == "las")
    throw Failure{ErrorCode::kImageUnsupported, "its space is left-anterior-superior; save it as LPS or RAS"};
  return std::nullopt;
}

/// \param first  the axis of the columns: 1 where a colour axis comes before
void ReadFrame(const Fields& fields, std::size_t first, std::size_t dimensions, ImageHeader& header) {
  if (const std::string* spacings = fields.Find({"spacings"})) {
    const auto words = Words(*spacings);
    for (std::size_t axis = 0; axis < 3 && first + axis < words.size(); ++axis) {
      const double spacing = ParseNumber(words[first + axis], "spacings");
      header.spacing[axis] = spacing;
    }
  }
  const std::string* directions = fields.Find({"space directions"});
  if (directions == nullptr) return;
  const auto signs = FindFrame(fields, header.frame);
  // vectors in brackets, "none" for an axis that is no length
  const auto vectors = Words(*directions, " \t");
  std::string joined;
  std::size_t axis = 0;
  std::vector<std::vector<double>> rows;
  for (const auto part : vectors) {
    joined += part;
    if (joined == "none" || joined.ends_with(')')) {
      if (axis++ >= first)
        rows.push_back(joined == "none" ? std::vector<double>{} : ParseNumbers(joined, "space directions"));
      joined.clear();
    }
  }
  if (dimensions - first != 3) return;
  if (rows.size() != 3) throw Failure{ErrorCode::kImageUndecodable, "its space directions are not three"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (rows[i].size() != 3)
      throw Failure{ErrorCode::kImageUndecodable, "its space directions are not three vectors"};
    header.spacing[i] =
        std::sqrt(rows[i][0] * rows[i][0] + rows[i][1] * rows[i][1] + rows[i][2] * rows[i][2]);
    if (!(header.spacing[i] > 0))
      throw Failure{ErrorCode::kImageGeometryInvalid, "one of its space directions has no length"};
    for (std::size_t k = 0; k < 3; ++k)
      header.direction[i][k] = signs ? (*signs)[k] * rows[i][k] / header.spacing[i] : 0.0;
  }
  const std::string* origin = fields.Find({"space origin"});
  if (origin == nullptr || !signs) return;
  const auto place = ParseNumbers(*origin, "space origin");
  if (place.size() != 3) throw Failure{ErrorCode::kImageUndecodable, "its space origin is no place"};
  for (std::size_t k = 0; k < 3; ++k) header.origin[k] = (*signs)[k] * place[k];
}

/// Segment names that 3D Slicer keeps: Segment0_Name, Segment0_LabelValue, Segment0_Layer.
void ReadSegmentNames(const Fields& fields, ImportReply& reply) {
  for (std::size_t i = 0; i < kMostSegments; ++i) {
    const std::string segment = "Segment" + std::to_string(i);
    const auto name = fields.pairs.find(segment + "_Name");
    const auto label = fields.pairs.find(segment + "_LabelValue");
    if (name == fields.pairs.end() || label == fields.pairs.end()) continue;
    const std::int64_t value = ParseWhole(label->second, "LabelValue");
    if (value < 1 || value > std::numeric_limits<std::int32_t>::max()) continue;
    const auto layer = fields.pairs.find(segment + "_Layer");
    const std::int64_t in_layer = layer == fields.pairs.end() ? 0 : ParseWhole(layer->second, "Layer");
    if (in_layer < 0 || in_layer >= static_cast<std::int64_t>(reply.header.channels)) continue;
    SegmentName& entry = reply.names[reply.header.segments++];
    entry.layer = static_cast<std::uint32_t>(in_layer);
    name->second.copy(entry.name, sizeof(entry.name) - 1);
    entry.label = static_cast<std::int32_t>(value);
  }
}

}  // namespace

void ReadNrrd(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kNrrd;
  const Fields fields = ParseFields(ReadBegin(job.file, kLongestHeader));
  const std::int64_t dimension = ParseWhole(fields.Need("dimension"), "dimension");
  std::vector<std::int64_t> sides;
  for (const auto word : Words(fields.Need("sizes"))) sides.push_back(ParseWhole(word, "sizes"));
  if (dimension < 2 || dimension > 5 || sides.size() != static_cast<std::size_t>(dimension))
    throw Failure{ErrorCode::kImageUndecodable, "dimension and sizes of its header do not agree"};

  StoredSamples stored;
  const std::string type = LowerCase(fields.Need("type"));
  bool is_known = false;
  for (const auto& [name, stored_type] : kTypes) {
    if (type == name) stored.type = stored_type, is_known = true;
  }
  if (!is_known) throw Failure{ErrorCode::kImageUnsupported, "its type is not read"};
  // colours come as a first axis of three
  const std::string* kinds = fields.Find({"kinds"});
  const bool is_color = sides[0] == 3 && stored.type == StoredType::kUint8 && dimension >= 3 &&
                        kinds != nullptr &&
                        (LowerCase(*kinds).starts_with("rgb-color") ||
                         LowerCase(*kinds).starts_with("vector") || LowerCase(*kinds).starts_with("3-color"));
  // segments that overlap lie in layers: 3D Slicer writes those as a first axis
  const bool is_layered =
      dimension == 4 && kinds != nullptr && LowerCase(*kinds).starts_with("list") && sides[0] >= 1;
  if (is_layered && sides[0] > static_cast<std::int64_t>(kMostLayers)) {
    throw Failure{ErrorCode::kImageTooLarge,
                  "its segments lie in more than " + std::to_string(kMostLayers) + " layers"};
  }
  const std::size_t first = is_color || is_layered ? 1 : 0;
  SetSides(std::vector<std::int64_t>(sides.begin() + static_cast<std::ptrdiff_t>(first), sides.end()), job,
           header);
  header.channels = is_color ? 3 : is_layered ? static_cast<std::uint32_t>(sides[0]) : 1;
  header.is_layered = is_layered ? 1 : 0;
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));

  const std::string encoding = LowerCase(fields.Need("encoding"));
  stored.is_deflated = encoding == "gzip" || encoding == "gz";
  if (!stored.is_deflated && encoding != "raw")
    throw Failure{ErrorCode::kImageUnsupported, "its encoding is not read; save it as raw or gzip"};
  if (const std::string* endian = fields.Find({"endian"}))
    stored.is_big_endian = StoredBytes(stored.type) > 1 && LowerCase(*endian) == "big";
  ReadFrame(fields, first, static_cast<std::size_t>(dimension), header);
  CheckGeometry(header);
  CheckSize(header, job.request);
  ReadSegmentNames(fields, reply);

  const std::string* detached = fields.Find({"data file", "datafile"});
  if (detached == nullptr && !fields.has_data)
    throw Failure{ErrorCode::kImageTruncated, "it ends within its header"};
  if (detached != nullptr && LowerCase(*detached).starts_with("list"))
    throw Failure{ErrorCode::kImageUnsupported, "its samples are spread over several files"};
  if (detached != nullptr && !FindDataFile(job, *detached, header)) return;
  const InputFile& file = detached != nullptr ? *job.data_file : job.file;
  stored.begin = detached != nullptr ? 0 : fields.end;
  if (const std::string* lines = fields.Find({"line skip", "lineskip"}); lines != nullptr && *lines != "0")
    throw Failure{ErrorCode::kImageUnsupported, "it uses \"line skip\"; save it again without"};
  if (const std::string* skip = fields.Find({"byte skip", "byteskip"})) {
    const std::int64_t bytes = ParseWhole(*skip, "byte skip");
    const std::uint64_t needed = CheckedProduct({header.SampleCount(), StoredBytes(stored.type)});
    if (bytes < -1 || (bytes != 0 && stored.is_deflated))
      throw Failure{ErrorCode::kImageUndecodable, "its \"byte skip\" makes no sense"};
    if (bytes == -1) stored.begin = file.bytes - std::min(needed, file.bytes);
    if (bytes > 0 && __builtin_add_overflow(stored.begin, static_cast<std::uint64_t>(bytes), &stored.begin))
      throw Failure{ErrorCode::kImageUndecodable, "its \"byte skip\" makes no sense"};
  }
  CheckBytesPresent(header, stored, file, job.request);
  if (job.samples != nullptr) ReadSamples(header, stored, file, job.samples);
}

}  // namespace trocar::images::import
