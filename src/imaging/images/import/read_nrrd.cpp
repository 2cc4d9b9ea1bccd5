// SPDX-License-Identifier: Apache-2.0
// Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html; where that leaves something open, what Teem
// (parseNrrd.c, enumsNrrd.c, read.c) and pynrrd (reader.py) make of it. Segments: vtkMRMLSegmentationStorageNode.cxx of 3D Slicer.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "byte_source.h"
#include "header_text.h"
#include "reader.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

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

/// Without its blanks, as "byteskip" may be written for "byte skip".
std::string WithoutBlanks(std::string_view name) {
  std::string short_name;
  for (const char c : LowerCase(name)) {
    if (c != ' ') short_name += c;
  }
  return short_name;
}

/// "\\n" and "\\\\" of a key or a value.
std::string Unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape =
        text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\');
    plain += !is_escape ? text[i] : text[++i] == 'n' ? '\n' : '\\';
  }
  return plain;
}

/// Fields by lower-case name, key/value pairs as written, the names that follow "data file: LIST", and where the header ends.
struct Fields {
  std::map<std::string, std::string, std::less<>> values;
  std::map<std::string, std::string, std::less<>> pairs;
  std::vector<std::string> list;
  std::uint64_t end = 0;
  bool has_data = false;  // the blank line was there

  const std::string* Find(std::string_view name) const {
    const auto found = values.find(WithoutBlanks(name));
    return found != values.end() ? &found->second : nullptr;
  }
  const std::string& Need(const char* name) const {
    const std::string* value = Find(name);
    if (value == nullptr)
      throw Failure{ErrorCode::kImageUndecodable, std::string("its header lacks ") + name};
    return *value;
  }
};

bool IsField(std::string_view name) {
  constexpr std::string_view kFields[] = {"content",
                                          "number",
                                          "type",
                                          "blocksize",
                                          "dimension",
                                          "space",
                                          "spacedimension",
                                          "sizes",
                                          "spacings",
                                          "thicknesses",
                                          "axismins",
                                          "axismaxs",
                                          "spacedirections",
                                          "centers",
                                          "centerings",
                                          "kinds",
                                          "labels",
                                          "units",
                                          "min",
                                          "max",
                                          "oldmin",
                                          "oldmax",
                                          "endian",
                                          "encoding",
                                          "lineskip",
                                          "byteskip",
                                          "sampleunits",
                                          "spaceunits",
                                          "spaceorigin",
                                          "measurementframe",
                                          "datafile"};
  return std::find(std::begin(kFields), std::end(kFields), name) != std::end(kFields);
}

bool IsList(std::string_view data_file) {
  const auto words = Words(data_file, " \t");
  return !words.empty() && words[0] == "LIST" && words.size() <= 2;
}

/// \return the line from `at` on, of which `at` is set to the next
std::string_view NextLine(std::string_view text, std::size_t& at) {
  const std::size_t end = std::min(text.find('\n', at), text.size());
  std::string_view line = text.substr(at, end - at);
  at = std::min(end + 1, text.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

Fields ParseFields(std::string_view text, bool is_whole) {
  Fields fields;
  std::size_t at = 0;
  const std::string_view mark = NextLine(text, at);
  if (constexpr std::string_view kOldest = "NRRD00.01"; mark != kOldest) {
    const bool is_version =
        mark.size() == 8 && mark.substr(4).find_first_not_of("0123456789") == std::string_view::npos;
    if (!is_version) throw Failure{ErrorCode::kImageUndecodable, "its first line is no mark of a NRRD file"};
    if (mark > "NRRD0005") throw Failure{ErrorCode::kImageUnsupported, "its version of NRRD is newer than 5"};
  }
  while (at < text.size()) {
    const std::string_view line = NextLine(text, at);
    fields.end = at;
    if (line.empty()) {
      fields.has_data = true;
      return fields;
    }
    if (line.starts_with('#')) continue;
    const std::size_t colon = line.find(':'), pair = line.find(":=");
    if (colon == std::string_view::npos)
      throw Failure{ErrorCode::kImageUndecodable, "a line of its header is neither field nor comment"};
    const std::string_view written = Trimmed(line.substr(0, colon));
    const std::string name = WithoutBlanks(written);
    // a key may hold a colon, and a field's value may hold ":="
    if (pair != std::string_view::npos && (colon == pair || !IsField(name))) {
      fields.pairs.insert_or_assign(Unescaped(line.substr(0, pair)),
                                    Unescaped(Trimmed(line.substr(pair + 2))));
      continue;
    }
    if (!IsField(name)) continue;  // of another program
    const std::string_view value = Trimmed(line.substr(colon + 1));
    if (!fields.values.emplace(name, value).second)
      throw Failure{ErrorCode::kImageUndecodable, "its header has the field " + Shown(written) + " twice"};
    if (name != "datafile" || !IsList(value)) continue;
    // the list ends the header
    while (at < text.size()) {
      const std::string_view file = Trimmed(NextLine(text, at));
      if (file.empty()) break;
      fields.list.emplace_back(file);
    }
    return fields;
  }
  if (!is_whole && fields.Find("data file") == nullptr) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its header is longer than " + std::to_string(kLongestHeader >> 10) + " KiB"};
  }
  return fields;
}

/// One axis of the array as its header describes it.
struct Axis {
  std::int64_t size = 0;
  std::string kind;                                  // in small letters; empty where it is not said
  std::optional<std::array<double, 3>> direction{};  // of one step, in the file's frame [mm]
  double spacing = 0;                                // [mm]; 0: not said
  bool is_spatial = false;
};

/// Signs that turn the file's axes into left, posterior, superior; none for a frame that is not the
/// patient's.
std::optional<std::array<double, 3>> FindFrame(const Fields& fields, FileFrame& frame) {
  const std::string* space = fields.Find("space");
  if (space == nullptr) return std::nullopt;
  std::string name;
  for (const char c : LowerCase(*space)) {
    if (c != ' ' && c != '-') name += c;
  }
  if (constexpr std::string_view kTime = "time"; name.ends_with(kTime))
    name.resize(name.size() - kTime.size());
  if (name == "leftposteriorsuperior" || name == "lps" || name == "lpst") {
    frame = FileFrame::kLps;
    return std::array{1.0, 1.0, 1.0};
  }
  if (name == "rightanteriorsuperior" || name == "ras" || name == "rast") {
    frame = FileFrame::kRas;
    return std::array{-1.0, -1.0, 1.0};
  }
  // ITK turns its first coordinate round where the format's second one differs: the two readings are mirrored
  if (name == "leftanteriorsuperior" || name == "las" || name == "last") {
    throw Failure{
        ErrorCode::kImageGeometryInvalid,
        "its space is left-anterior-superior, which programs read in two ways; save it as LPS or RAS"};
  }
  return std::nullopt;
}

/// Vectors in brackets; an empty one for an axis that is "none" or no number.
std::vector<std::vector<double>> ParseVectors(std::string_view text, const char* field) {
  std::vector<std::vector<double>> vectors;
  for (text = Trimmed(text); !text.empty(); text = Trimmed(text)) {
    constexpr std::string_view kNone = "none";
    if (LowerCase(text.substr(0, kNone.size())) == kNone) {
      vectors.emplace_back();
      text.remove_prefix(kNone.size());
      continue;
    }
    const std::size_t end = text.find(')');
    if (text.front() != '(' || end == std::string_view::npos)
      throw Failure{ErrorCode::kImageUndecodable,
                    std::string(field) + " in its header is no vector in brackets"};
    vectors.push_back(ParseNumbers(text.substr(1, end - 1), field));
    if (std::all_of(vectors.back().begin(), vectors.back().end(),
                    [](double part) { return std::isnan(part); }))
      vectors.back().clear();
    text.remove_prefix(end + 1);
  }
  return vectors;
}

/// Units that a field names one by one, as lengths; none for a field that is not there.
std::vector<std::optional<double>> ParseUnits(const Fields& fields, const char* field, std::size_t count,
                                              const std::vector<bool>& is_length) {
  const std::string* text = fields.Find(field);
  if (text == nullptr) return {};
  const auto words = QuotedWords(*text);
  if (words.size() != count) {
    throw Failure{ErrorCode::kImageUndecodable, "the number of \"" + std::string(field) +
                                                    "\" in its header is " + std::to_string(words.size()) +
                                                    ", not " + std::to_string(count)};
  }
  std::vector<std::optional<double>> units(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (is_length[i]) units[i] = ParseUnitMm(words[i]);
  }
  return units;
}

/// The one unit of a list; nothing where it says none.
/// \return false where there are several
bool FindSameUnit(const std::vector<std::optional<double>>& units, std::optional<double>& same) {
  for (const std::optional<double>& unit : units) {
    if (unit && same && *unit != *same) return false;
    if (unit) same = unit;
  }
  return true;
}

/// Sizes and kinds of the axes.
std::vector<Axis> ReadAxes(const Fields& fields) {
  const std::int64_t dimension = ParseWhole(fields.Need("dimension"), "dimension");
  constexpr std::int64_t kMostDimensions = 16;  // Teem's
  if (dimension < 1 || dimension > kMostDimensions) {
    throw Failure{ErrorCode::kImageUndecodable,
                  "its dimension is not between 1 and " + std::to_string(kMostDimensions)};
  }
  std::vector<Axis> axes;
  for (const auto word : Words(fields.Need("sizes"))) axes.emplace_back().size = ParseWhole(word, "sizes");
  if (axes.size() != static_cast<std::size_t>(dimension))
    throw Failure{ErrorCode::kImageUndecodable, "dimension and sizes of its header do not agree"};
  for (const Axis& axis : axes) {
    if (axis.size < 1) throw Failure{ErrorCode::kImageUndecodable, "one of its sizes is 0 or negative"};
  }
  if (const std::string* kinds = fields.Find("kinds")) {
    const auto words = Words(*kinds, " \t");
    if (words.size() != axes.size())
      throw Failure{ErrorCode::kImageUndecodable, "dimension and kinds of its header do not agree"};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      axes[i].kind = LowerCase(words[i]);
      if (axes[i].kind == "none" || axes[i].kind == "???") axes[i].kind.clear();
    }
  }
  return axes;
}

/// Where the axes lie, in the header's own unit.
struct Space {
  std::size_t dimensions = 0;                // 0: the header gives no directions
  std::vector<std::vector<double>> vectors;  // [axis] one step; empty for an axis that is no direction
};

/// Reads the directions and says of each axis whether it is one in space.
Space ReadSpace(const Fields& fields, std::vector<Axis>& axes) {
  Space space;
  const std::string* directions = fields.Find("space directions");
  if (directions == nullptr) {
    for (Axis& axis : axes)
      axis.is_spatial = axis.kind.empty() || axis.kind == "domain" || axis.kind == "space";
    return space;
  }
  space.vectors = ParseVectors(*directions, "space directions");
  if (space.vectors.size() != axes.size())
    throw Failure{ErrorCode::kImageUndecodable, "its space directions are not one for each of its axes"};
  for (const auto& vector : space.vectors) {
    if (vector.empty()) continue;
    if (space.dimensions != 0 && vector.size() != space.dimensions)
      throw Failure{ErrorCode::kImageUndecodable,
                    "its space directions differ in how many numbers they have"};
    space.dimensions = vector.size();
  }
  constexpr std::size_t kWithTime = 4;
  if (space.dimensions < 2 || space.dimensions > kWithTime)
    throw Failure{ErrorCode::kImageUnsupported, "its space has neither two nor three dimensions"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto& vector = space.vectors[i];
    axes[i].is_spatial = !vector.empty();
    if (vector.size() < kWithTime || vector[3] == 0) continue;
    if (vector[0] != 0 || vector[1] != 0 || vector[2] != 0)
      throw Failure{ErrorCode::kImageGeometryInvalid,
                    "one of its space directions leads through time as well"};
    axes[i].is_spatial = false;
    axes[i].kind = "time";
  }
  return space;
}

/// Units of length of the header [mm].
struct Units {
  std::array<double, 3> of_space = {1, 1, 1};  // of directions and places, by their numbers
  std::vector<double> of_axes;                 // of spacings
};

/// Units of the space's directions, or else of the axes; millimetres where neither is said.
Units ReadUnits(const Fields& fields, const std::vector<Axis>& axes, const Space& space) {
  std::vector<bool> is_spatial, is_length(space.dimensions, true);
  for (const Axis& axis : axes) is_spatial.push_back(axis.is_spatial);
  if (space.dimensions > 3) is_length[3] = false;
  const auto axis_units = ParseUnits(fields, "units", axes.size(), is_spatial);
  std::optional<double> of_axes, of_space;
  const bool is_one = FindSameUnit(axis_units, of_axes);
  Units units;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const bool is_said = i < axis_units.size() && axis_units[i];
    units.of_axes.push_back(is_said ? *axis_units[i] : of_axes.value_or(1.0));
  }
  if (space.dimensions == 0) return units;
  const auto space_units = ParseUnits(fields, "space units", space.dimensions, is_length);
  const bool is_one_space = FindSameUnit(space_units, of_space);
  if (of_space && of_axes && (!is_one || !is_one_space || *of_space != *of_axes))
    throw Failure{ErrorCode::kImageUndecodable, "\"units\" and \"space units\" of its header do not agree"};
  if (!of_space && !is_one)
    throw Failure{ErrorCode::kImageUndecodable, "\"units\" of its header differ from axis to axis"};
  for (std::size_t k = 0; k < 3; ++k) {
    const bool is_said = k < space_units.size() && space_units[k];
    units.of_space[k] = is_said ? *space_units[k] : of_space.value_or(of_axes.value_or(1.0));
  }
  return units;
}

/// Sets the steps of the axes: by the directions, else by the spacings.
void ReadSteps(const Fields& fields, const Space& space, const Units& units, std::vector<Axis>& axes) {
  for (std::size_t i = 0; i < axes.size() && space.dimensions > 0; ++i) {
    if (!axes[i].is_spatial) continue;
    auto& step = axes[i].direction.emplace();
    for (std::size_t k = 0; k < std::min<std::size_t>(space.dimensions, 3); ++k)
      step[k] = units.of_space[k] * space.vectors[i][k];
    axes[i].spacing = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    if (axes[i].spacing == 0)
      throw Failure{ErrorCode::kImageGeometryInvalid, "one of its space directions has no length"};
  }
  const std::string* spacings = fields.Find("spacings");
  if (spacings == nullptr || space.dimensions > 0) return;
  const auto numbers = ParseNumbers(*spacings, "spacings");
  if (numbers.size() != axes.size())
    throw Failure{ErrorCode::kImageUndecodable, "dimension and spacings of its header do not agree"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].is_spatial && !std::isnan(numbers[i]))
      axes[i].spacing = units.of_axes[i] * std::fabs(numbers[i]);
  }
}

/// Place of the first sample, in the file's frame [mm].
std::array<double, 3> ReadOrigin(const Fields& fields, const Space& space, const Units& units) {
  std::array<double, 3> origin{};
  const std::string* written = fields.Find("space origin");
  if (written == nullptr || space.dimensions == 0) return origin;
  const auto places = ParseVectors(*written, "space origin");
  if (places.size() != 1 || (!places[0].empty() && places[0].size() != space.dimensions))
    throw Failure{ErrorCode::kImageUndecodable, "its space origin is no place in its space"};
  for (std::size_t k = 0; k < std::min<std::size_t>(places[0].size(), 3); ++k)
    origin[k] = units.of_space[k] * places[0][k];
  return origin;
}

/// Directions and place, where the space is the patient's.
void ReadFrame(const Fields& fields, const std::vector<const Axis*>& spatial, const Space& space,
               const std::array<double, 3>& origin, ImageHeader& header) {
  for (std::size_t i = 0; i < spatial.size(); ++i) header.spacing[i] = spatial[i]->spacing;
  if (space.dimensions < 3) return;
  FileFrame frame = FileFrame::kNotSaid;
  const auto signs = FindFrame(fields, frame);
  if (!signs) return;
  header.frame = frame;
  for (std::size_t i = 0; i < spatial.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      header.direction[i][k] = (*signs)[k] * (*spatial[i]->direction)[k] / header.spacing[i];
  }
  if (spatial.size() == 2) {  // one slice: it has two axes and a side that it is seen from
    const auto &x = header.direction[0], &y = header.direction[1];
    for (std::size_t k = 0; k < 3; ++k)
      header.direction[2][k] = x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
  }
  for (std::size_t k = 0; k < 3; ++k) header.origin[k] = (*signs)[k] * origin[k];
}

/// What a segment is, from the tag TerminologyEntry of 3D Slicer: "context~category~type~modifier~...", each but the first as
/// "SCT^10200004^Liver". Of codes of SNOMED the type's, its modifier's and behind "@" the region's: "10200004", "64033007 24028007",
/// "108369006 @10200004". Empty where there is none of SNOMED.
/// Source: 3D Slicer, vtkSlicerTerminologiesModuleLogic, SerializeTerminologyEntry.
std::string FindSegmentCode(std::string_view tags) {
  constexpr std::string_view kTag = "TerminologyEntry:";
  const auto begin = tags.find(kTag);
  if (begin == std::string_view::npos) return {};
  std::string_view entry = tags.substr(begin + kTag.size());
  entry = entry.substr(0, entry.find('|'));
  std::array<std::string_view, 6> parts;  // context, category, type, its modifier, context, region
  for (std::string_view& part : parts) {
    part = entry.substr(0, entry.find('~'));
    entry.remove_prefix(std::min(entry.size(), part.size() + 1));
  }
  const auto code = [](std::string_view part) {
    const std::string_view scheme = part.substr(0, part.find('^'));
    std::string_view value = part.substr(std::min(part.size(), scheme.size() + 1));
    value = value.substr(0, value.find('^'));
    const bool is_snomed = scheme == "SCT" || scheme == "SRT" || scheme == "SNM3" || scheme == "99SDM";
    const bool is_plain = value.size() <= 18 && std::all_of(value.begin(), value.end(), [](char c) {
                            return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || c == '-';
                          });
    return std::string(is_snomed && is_plain ? value : std::string_view());
  };
  std::string text = code(parts[2]);
  if (text.empty()) return {};
  if (const std::string modifier = code(parts[3]); !modifier.empty()) text += " " + modifier;
  if (const std::string region = code(parts[5]); !region.empty()) text += " @" + region;
  return text;
}

/// Segments of 3D Slicer, Segment0_Name, Segment0_LabelValue, Segment0_Layer. Before version 4.11 it wrote neither label nor
/// layer: each segment then is the label 1 of a layer of its own.
void ReadSegmentNames(const Fields& fields, ImportReply& reply) {
  const auto find = [&](std::size_t i, const char* key) -> const std::string* {
    const auto found = fields.pairs.find("Segment" + std::to_string(i) + "_" + key);
    return found == fields.pairs.end() ? nullptr : &found->second;
  };
  const auto layers = static_cast<std::int64_t>(reply.header.is_layered != 0 ? reply.header.channels : 1);
  for (std::size_t i = 0; i < kMostSegments; ++i) {
    const std::string *name = find(i, "Name"), *label = find(i, "LabelValue"), *layer = find(i, "Layer");
    if (name == nullptr) name = find(i, "ID");
    if (name == nullptr) continue;
    const std::int64_t value = label == nullptr ? 1 : ParseWhole(*label, "LabelValue");
    if (value < 1 || value > std::numeric_limits<std::int32_t>::max()) continue;
    const bool has_own_layer = layers > 1 || label == nullptr;
    const std::int64_t in_layer = layer != nullptr ? ParseWhole(*layer, "Layer")
                                  : has_own_layer  ? static_cast<std::int64_t>(i)
                                                   : 0;
    if (layer == nullptr && in_layer >= layers) {
      throw Failure{ErrorCode::kImageUndecodable,
                    "it names segments without saying which label of which layer they are"};
    }
    if (in_layer < 0 || in_layer >= layers) {
      throw Failure{ErrorCode::kImageUndecodable, "one of its segments lies in layer " +
                                                      std::to_string(in_layer) + ", and it has " +
                                                      std::to_string(layers)};
    }
    SegmentName& entry = reply.names[reply.header.segments++];
    entry.layer = static_cast<std::uint32_t>(in_layer);
    name->copy(entry.name, sizeof(entry.name) - 1);
    if (const std::string* tags = find(i, "Tags"))
      FindSegmentCode(*tags).copy(entry.code, sizeof(entry.code) - 1);
    entry.label = static_cast<std::int32_t>(value);
  }
}

bool HasSegments(const Fields& fields) {
  return fields.pairs.contains("Segment0_Name") || fields.pairs.contains("Segment0_ID");
}

bool IsColour(const std::string& kind) {
  constexpr const char* kKinds[] = {"rgb-color", "rgbcolor", "rgb", "3-color", "vector"};
  return std::find(std::begin(kKinds), std::end(kKinds), kind) != std::end(kKinds);
}

/// What the axis that is no direction in space holds: colours, or layers of segments.
void ReadChannels(const Fields& fields, const Axis& axis, std::size_t spatial_axes, StoredType type,
                  ImageHeader& header) {
  const std::string count = std::to_string(axis.size);
  if (axis.kind == "time" || axis.kind == "domain" || axis.kind == "space")
    throw Failure{ErrorCode::kImageUnsupported, "it holds " + count + " volumes; extract one of them"};
  const bool has_segments = HasSegments(fields);
  if (axis.size == 3 && type == StoredType::kUint8 && IsColour(axis.kind) && !has_segments) {
    header.channels = 3;
    return;
  }
  if (spatial_axes != 3 || !(has_segments || axis.kind == "list")) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "it has " + count +
                      " values a voxel, which are neither colours of 8 bits nor "
                      "layers of segments"};
  }
  if (axis.size > static_cast<std::int64_t>(kMostLayers)) {
    throw Failure{ErrorCode::kImageTooLarge,
                  "it has " + count + " layers, more than " + std::to_string(kMostLayers)};
  }
  header.channels = static_cast<std::uint32_t>(axis.size);
  header.is_layered = 1;
}

/// Sets sides, channels and how the channels are stored.
void ReadShape(const Fields& fields, const Job& job, ImageHeader& header, StoredSamples& stored) {
  std::vector<Axis> axes = ReadAxes(fields);
  const Space space = ReadSpace(fields, axes);
  const Units units = ReadUnits(fields, axes, space);
  ReadSteps(fields, space, units, axes);
  std::vector<const Axis*> spatial;
  const Axis* channels = nullptr;
  std::uint64_t run = 1;
  std::vector<std::int64_t> sides;
  for (Axis& axis : axes) {
    if (axis.is_spatial && spatial.size() < 3) {
      spatial.push_back(&axis);
      sides.push_back(axis.size);
    } else if (axis.size > 1 && channels != nullptr) {
      throw Failure{ErrorCode::kImageUnsupported, "several of its axes are no directions in space"};
    } else if (axis.size > 1) {
      if (axis.is_spatial) axis.kind = "space";
      channels = &axis;
      // samples before it lie side by side
      for (const std::int64_t side : sides) run = CheckedProduct({run, static_cast<std::uint64_t>(side)});
    }
  }
  if (spatial.size() < 2)
    throw Failure{ErrorCode::kImageUnsupported, "fewer than two of its axes are directions in space"};
  SetSides(sides, job, header);
  header.channels = 1;
  if (channels != nullptr) {
    ReadChannels(fields, *channels, spatial.size(), stored.type, header);
    stored.run = run;
  } else if (spatial.size() == 3 && HasSegments(fields)) {
    // one layer: an axis of the kind list with one sample
    const bool has_list =
        std::any_of(axes.begin(), axes.end(), [](const Axis& axis) { return axis.kind == "list"; });
    header.is_layered = has_list ? 1 : 0;
  }
  ReadFrame(fields, spatial, space, ReadOrigin(fields, space, units), header);
}

/// How the samples are written down.
Packing ReadEncoding(const Fields& fields) {
  const std::string encoding = LowerCase(fields.Need("encoding"));
  if (encoding == "raw") return Packing::kPlain;
  if (encoding == "gzip" || encoding == "gz") return Packing::kDeflated;
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") return Packing::kText;
  if (encoding == "hex") return Packing::kHex;
  throw Failure{ErrorCode::kImageUnsupported,
                "its encoding " + Shown(encoding) + " is not read; save it as raw or gzip"};
}

bool ReadByteOrder(const Fields& fields, const StoredSamples& stored) {
  const std::string* endian = fields.Find("endian");
  const std::string order = endian == nullptr ? "" : LowerCase(*endian);
  if (StoredBytes(stored.type) == 1 || stored.packing == Packing::kText || order == "little") return false;
  if (order == "big") return true;
  if (endian == nullptr)
    throw Failure{ErrorCode::kImageUndecodable,
                  "its header lacks endian, which samples of several bytes need"};
  throw Failure{ErrorCode::kImageUndecodable, "endian of its header is neither little nor big"};
}

/// The name of the one data file; nothing where the samples follow the header.
std::optional<std::string> FindDataName(const Fields& fields) {
  const std::string* detached = fields.Find("data file");
  if (detached == nullptr) return std::nullopt;
  const bool is_list = IsList(*detached);
  if (is_list && fields.list.empty())
    throw Failure{ErrorCode::kImageTruncated, "it ends before the list of its data files"};
  if (is_list && fields.list.size() == 1) return fields.list[0];
  // "slice%03d.raw 1 60 1"
  const auto percent = detached->find('%');
  const auto letter =
      percent == std::string::npos ? percent : detached->find_first_not_of("0123456789", percent + 1);
  if (is_list || (letter != std::string::npos && (*detached)[letter] == 'd'))
    throw Failure{ErrorCode::kImageUnsupported, "its samples are in several files"};
  return *detached;
}

/// Where the samples begin in the file that holds them, after "line skip" and "byte skip".
void ReadSkips(const Fields& fields, const ImageHeader& header, const InputFile& file,
               StoredSamples& stored) {
  if (const std::string* skip = fields.Find("line skip")) {
    const std::int64_t lines = ParseWhole(*skip, "line skip");
    if (lines < 0) throw Failure{ErrorCode::kImageUndecodable, "\"line skip\" of its header is negative"};
    stored.begin = SkipLines(file, stored.begin, static_cast<std::uint64_t>(lines));
  }
  const std::string* skip = fields.Find("byte skip");
  const std::int64_t bytes = skip == nullptr ? 0 : ParseWhole(*skip, "byte skip");
  if (bytes >= 0) {
    // within what is unpacked, as the format has it
    (stored.packing == Packing::kDeflated ? stored.skipped : stored.begin) +=
        static_cast<std::uint64_t>(bytes);
    return;
  }
  // -1: the samples are the last bytes; with Teem, -1-N: N bytes follow them
  const auto after = static_cast<std::uint64_t>(-(bytes + 1));
  if (stored.packing == Packing::kDeflated) {
    stored.bytes_after = after;
    return;
  }
  if (stored.packing != Packing::kPlain) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "its \"byte skip\" counts from the end of the file on, where its samples are text"};
  }
  std::uint64_t needed = BytesOfSamples(header, stored);
  if (__builtin_add_overflow(needed, after, &needed) ||
      needed > file.bytes - std::min(stored.begin, file.bytes)) {
    throw Failure{
        ErrorCode::kImageTruncated,
        "its \"byte skip\" counts back from the end of the file, which is too short for its samples"};
  }
  stored.begin = file.bytes - needed;
}

}  // namespace

void ReadNrrd(const Job& job, ImportReply& reply) {
  ImageHeader& header = reply.header;
  header.kind = FileKind::kNrrd;
  const Fields fields = ParseFields(ReadBegin(job.file, kLongestHeader), job.file.bytes <= kLongestHeader);
  if (!fields.has_data && fields.Find("data file") == nullptr) {
    throw Failure{ErrorCode::kImageTruncated,
                  "its header neither ends with an empty line nor names a data file"};
  }
  StoredSamples stored;
  const std::string type = LowerCase(fields.Need("type"));
  bool is_known = false;
  for (const auto& [name, stored_type] : kTypes) {
    if (type == name) stored.type = stored_type, is_known = true;
  }
  if (!is_known) throw Failure{ErrorCode::kImageUnsupported, "its type " + Shown(type) + " is not read"};
  ReadShape(fields, job, header, stored);
  header.samples = HandedOverAs(stored.type);
  header.bits = static_cast<std::uint32_t>(8 * StoredBytes(stored.type));
  stored.packing = ReadEncoding(fields);
  stored.is_big_endian = ReadByteOrder(fields, stored);
  CheckGeometry(header);
  CheckSize(header, job.request);
  ReadSegmentNames(fields, reply);

  const std::optional<std::string> name = FindDataName(fields);
  if (name && !FindDataFile(job, *name, header)) return;
  const InputFile& file = name ? *job.data_file : job.file;
  stored.begin = name ? 0 : fields.end;
  ReadSkips(fields, header, file, stored);
  CheckBytesPresent(header, stored, file, job.request);
  if (job.samples != nullptr) ReadSamples(header, stored, file, job.samples);
}

}  // namespace trocar::images::import
