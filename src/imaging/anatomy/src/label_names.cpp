// SPDX-License-Identifier: Apache-2.0
#include "label_names.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "trocar/base/to_integer.h"
#include "trocar/host/json.h"
#include "trocar/host/printable.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/image_stack.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using nlohmann::json;

using Names = std::vector<std::pair<std::string, int>>;

struct Table {
  Names names;
  bool has_regions = false;  ///< a label may be in several
  Names codes;
};

constexpr std::size_t kMostBytes = 1u << 20;
constexpr const char* kHow = "; write lines like: 5 liver";

std::string_view Trimmed(std::string_view text, std::string_view what = " \t\r\n") {
  const std::size_t begin = text.find_first_not_of(what);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(what) - begin + 1);
}

std::optional<int> ParseLabel(std::string_view text) {
  int label = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), label);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || label < 0) return std::nullopt;
  return label;
}

bool IsNumber(std::string_view text) {
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
}

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 'a' - 'A');
  }
  return lower;
}

/// UTF-8 of UTF-16 without its byte order mark; nothing where it is none.
std::optional<std::string> FromUtf16(std::string_view bytes, bool is_big_endian) {
  if (bytes.size() % 2 != 0) return std::nullopt;
  const auto unit = [&](std::size_t at) {
    const auto a = static_cast<unsigned char>(bytes[at]), b = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(is_big_endian ? a << 8 | b : b << 8 | a);
  };
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    std::uint32_t point = unit(i);
    if (point >= 0xd800 && point < 0xe000) {
      if (point >= 0xdc00 || i + 3 >= bytes.size() || (unit(i + 2) & 0xfc00) != 0xdc00) return std::nullopt;
      point = 0x10000 + ((point & 0x3ff) << 10 | (unit(i + 2) & 0x3ff));
      i += 2;
    }
    if (point < 0x80) {
      text += static_cast<char>(point);
      continue;
    }
    const int more = point < 0x800 ? 1 : point < 0x10000 ? 2 : 3;
    text += static_cast<char>((more == 1 ? 0xc0 : more == 2 ? 0xe0 : 0xf0) | point >> (6 * more));
    for (int k = more - 1; k >= 0; --k) text += static_cast<char>(0x80 | (point >> (6 * k) & 0x3f));
  }
  return text;
}

/// What a file is that is no text, or no table that is read; empty for text.
std::string DescribeOther(std::string_view bytes) {
  if (bytes.starts_with("PK")) return "it is a spreadsheet or an archive; save the table as CSV";
  if (bytes.starts_with("\x1f\x8b")) return "it is compressed; name the unpacked table";
  if (bytes.starts_with("NRRD"))
    return "it is an image; name a table of its labels, or give none where the image has the names";
  if (bytes.size() > 132 && bytes.substr(128, 4) == "DICM")
    return "it is a DICOM file; name a table of its labels";
  if (std::any_of(bytes.begin(), bytes.end(), [](char c) {
        return c >= 0 && c < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f';
      }))
    return "it is no text; name a table of labels and names";
  const std::string_view begin = Trimmed(bytes);
  if (begin.starts_with("<")) return "it is XML or HTML, which is not read; save the table as CSV or JSON";
  return {};
}

Error TwoNames(const std::string& source, int label, const std::string& one, const std::string& other) {
  return {ErrorCode::kLabelsMismatch, source + ": label " + std::to_string(label) + " has two names, " +
                                          host::Printable(one, 40) + " and " + host::Printable(other, 40) +
                                          "; leave one out"};
}

// --- JSON

/// Reads one document, and says at which field it is wrong.
class JsonTable {
 public:
  explicit JsonTable(std::string source) : source_(std::move(source)) {}

  base::Result<Table> Read(const json& document) const {
    if (document.is_array()) return ReadList(document, "");
    const json* table = &document;
    std::string at;
    for (const char* key : {"labels", "class_map", "label_map", "names"}) {
      if (!table->contains(key) || !(*table)[key].is_structured()) continue;
      table = &(*table)[key], at = key;
      break;
    }
    if (document.contains("segmentAttributes")) return ReadDcmqi(document["segmentAttributes"]);
    if (table->is_array()) return ReadList(*table, at);
    return ReadObject(*table, at);
  }

 private:
  Error Wrong(const std::string& field, const std::string& why) const {
    return {ErrorCode::kJsonField, source_ + ": at " + host::Printable(field, 60) + ": " + why};
  }

  std::optional<int> LabelIn(const json& value) const {
    if (value.is_string()) return ParseLabel(Trimmed(value.get<std::string>()));
    if (!value.is_number()) return std::nullopt;
    const double number = value.get<double>();
    if (!(number >= 0 && number <= images::kLargestLabel) || number != std::floor(number))
      return std::nullopt;
    return base::TruncateTo<int>(number);
  }

  base::Result<Table> ReadObject(const json& table, const std::string& at) const {
    struct Region {
      std::string name;
      std::vector<int> labels;
    };
    Names names;
    std::vector<Region> regions;
    const bool is_by_label =
        !table.empty() && std::all_of(table.items().begin(), table.items().end(),
                                      [](const auto& item) { return ParseLabel(item.key()).has_value(); });
    for (const auto& [key, value] : table.items()) {
      const std::string field = at.empty() ? key : at + "." + key;
      if (is_by_label) {
        const json* name = &value;
        for (const char* member : {"name", "label", "structure"}) {
          if (value.is_object() && value.contains(member)) name = &value[member];
        }
        if (!name->is_string()) return Wrong(field, "the label's name must be a text");
        names.emplace_back(name->get<std::string>(), *ParseLabel(key));
        continue;
      }
      // nnU-Net: a region is a list of labels, a label of its own a number
      const json& one = value.is_object() && value.contains("label") ? value["label"] : value;
      Region region{key, {}};
      for (const json& part : one.is_array() ? one : json::array({one})) {
        const auto label = LabelIn(part);
        if (!label) return Wrong(field, "must be a label (a whole number from 0 on), or a list of labels");
        region.labels.push_back(*label);
      }
      if (region.labels.empty()) return Wrong(field, "the region has no label");
      regions.push_back(std::move(region));
    }
    const bool has_regions = std::any_of(regions.begin(), regions.end(),
                                         [](const Region& region) { return region.labels.size() > 1; });
    std::stable_sort(regions.begin(), regions.end(),
                     [](const Region& a, const Region& b) { return a.labels.size() < b.labels.size(); });
    std::map<int, std::pair<std::string, std::size_t>> smallest;
    for (const Region& region : regions) {
      for (const int label : region.labels) {
        const auto [other, is_new] = smallest.try_emplace(label, region.name, region.labels.size());
        if (label != 0 && !is_new && (!has_regions || other->second.second == region.labels.size())) {
          return TwoNames(source_, label, other->second.first, region.name);
        }
        names.emplace_back(region.name, label);
      }
    }
    return Table{std::move(names), has_regions};
  }

  base::Result<Table> ReadList(const json& list, const std::string& at) const {
    Names names;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const json& entry = list[i];
      const std::string field = at + "[" + std::to_string(i) + "]";
      if (!entry.is_object()) return Wrong(field, "must be an object with a label and a name");
      std::optional<int> label;
      std::string name;
      for (const auto& [key, value] : entry.items()) {
        const std::string lower = LowerCase(key);
        const bool is_label = lower == "label" || lower == "id" || lower == "index" || lower == "value" ||
                              lower == "labelvalue" || lower == "labelid";
        if (is_label && LabelIn(value)) label = LabelIn(value);
        if ((lower == "name" || lower == "structure" || lower == "organ" || lower == "text" ||
             (lower == "label" && !label)) &&
            value.is_string() && (name.empty() || lower == "name"))
          name = value.get<std::string>();
      }
      if (!label || name.empty())
        return Wrong(field, "must have a label (a whole number from 0 on) and a name");
      names.emplace_back(name, *label);
    }
    return Table{std::move(names)};
  }

  /// dcmqi's description of a DICOM segmentation.
  base::Result<Table> ReadDcmqi(const json& groups) const {
    Names names, codes;
    for (const json& group : groups) {
      for (const json& segment : group.is_array() ? group : json::array({group})) {
        if (!segment.is_object() || !segment.contains("labelID") || !LabelIn(segment["labelID"]))
          return Wrong("segmentAttributes", "a segment has no labelID");
        std::string name;
        for (const char* member : {"SegmentLabel", "SegmentDescription"}) {
          if (name.empty() && segment.contains(member) && segment[member].is_string())
            name = segment[member].get<std::string>();
        }
        if (segment.contains("SegmentedPropertyTypeCodeSequence")) {
          const json& code = segment["SegmentedPropertyTypeCodeSequence"];
          if (name.empty() && code.is_object() && code.contains("CodeMeaning") &&
              code["CodeMeaning"].is_string())
            name = code["CodeMeaning"].get<std::string>();
        }
        if (name.empty())
          return Wrong("segmentAttributes",
                       "a segment has no SegmentLabel, SegmentDescription or CodeMeaning");
        const int label = *LabelIn(segment["labelID"]);
        names.emplace_back(name, label);
        if (const std::string code = CodeOf(segment); !code.empty()) codes.emplace_back(code, label);
      }
    }
    return Table{std::move(names), false, std::move(codes)};
  }

  /// As LabelVolume::codes has it; empty where there is none of SNOMED.
  static std::string CodeOf(const json& segment) {
    const auto code = [&](const char* sequence) -> std::string {
      if (!segment.contains(sequence) || !segment[sequence].is_object()) return {};
      const json& entry = segment[sequence];
      const auto text = [&](const char* member) {
        return entry.contains(member) && entry[member].is_string() ? entry[member].get<std::string>() : "";
      };
      const std::string scheme = text("CodingSchemeDesignator");
      const bool is_snomed = scheme == "SCT" || scheme == "SRT" || scheme == "SNM3" || scheme == "99SDM";
      return is_snomed ? text("CodeValue") : "";
    };
    const std::string type = code("SegmentedPropertyTypeCodeSequence");
    if (type.empty()) return {};
    const std::string side = code("SegmentedPropertyTypeModifierCodeSequence");
    const std::string region = code("AnatomicRegionSequence");
    return type + (side.empty() ? "" : " " + side) + (region.empty() ? "" : " @" + region);
  }

  std::string source_;
};

base::Result<Table> ReadJsonTable(const std::string& text, const std::string& source) {
  const auto document = host::ParseJson<json>(text, source);
  if (!document.ok()) return document.error();
  return JsonTable(source).Read(*document);
}

// --- text

struct Line {
  int number = 0;
  std::string text;
};

/// Lines that are not empty and no comment, whatever ends them.
std::vector<Line> LinesOf(std::string_view text) {
  std::vector<Line> lines;
  int number = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    ++number;
    const std::string_view line = Trimmed(text.substr(begin, end - begin));
    const bool is_comment = line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
    if (!line.empty() && !is_comment) lines.push_back({number, std::string(line)});
    begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
  }
  return lines;
}

/// Cells of a line; quotation marks hold separators together.
std::vector<std::string> CellsOf(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[i++];
      } else {
        is_quoted = !is_quoted;
      }
    } else if (line[i] == separator && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (std::string& cell : cells) cell = std::string(Trimmed(cell));
  return cells;
}

/// Where the columns of a header are.
struct Columns {
  char separator = ',';
  std::size_t label = 0, name = 0;
};

std::string PlainHeading(std::string_view cell) {
  std::string plain;
  for (const char c : LowerCase(cell)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

std::optional<Columns> FindColumns(std::string_view header) {
  // the first that is there counts
  constexpr std::array<std::string_view, 14> kLabels = {
      "labelvalue", "labelid", "labelnumber", "labelindex", "index", "id",    "value",
      "number",     "no",      "key",         "intensity",  "idx",   "class", "label"};
  constexpr std::array<std::string_view, 14> kNames = {
      "name",   "labelname", "structurename", "structure",   "organ", "segmentname", "segment",
      "region", "anatomy",   "roi",           "description", "text",  "classname",   "label"};
  for (const char separator : {'\t', ';', ','}) {
    const auto cells = CellsOf(header, separator);
    if (cells.size() < 2) continue;
    const auto find = [&](const auto& headings, std::size_t not_at) -> std::optional<std::size_t> {
      for (const std::string_view heading : headings) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
          if (i != not_at && PlainHeading(cells[i]) == heading) return i;
        }
      }
      return std::nullopt;
    };
    if (const auto name = find(kNames, cells.size())) {
      if (const auto label = find(kLabels, *name)) return Columns{separator, *label, *name};
    }
  }
  return std::nullopt;
}

Error NoEntry(const std::string& source, const Line& line,
              const std::string& why = "is no label and its name") {
  return {ErrorCode::kLabelsMismatch, source + ": line " + std::to_string(line.number) + " (" +
                                          host::Printable(line.text, 60) + ") " + why + kHow};
}

base::Result<Table> ReadColumns(const std::vector<Line>& lines, const Columns& columns,
                                const std::string& source) {
  Names names;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = CellsOf(lines[i].text, columns.separator);
    if (cells.size() <= std::max(columns.label, columns.name))
      return NoEntry(source, lines[i], "has fewer columns than the header");
    auto label = ParseLabel(cells[columns.label]);
    // spreadsheets write whole numbers as 5.0
    if (!label && cells[columns.label].ends_with(".0"))
      label = ParseLabel(std::string_view(cells[columns.label]).substr(0, cells[columns.label].size() - 2));
    if (!label || cells[columns.name].empty()) return NoEntry(source, lines[i]);
    names.emplace_back(cells[columns.name], *label);
  }
  return Table{std::move(names)};
}

std::vector<std::string> WordsOf(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(" \t", at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

/// The name in one line behind its label: in quotation marks at the end, or the words before the colour.
std::string NameIn(std::string_view rest) {
  const std::size_t last = rest.rfind('"'), first = rest.find('"');
  if (first != std::string_view::npos && last > first)
    return std::string(Trimmed(rest.substr(first + 1, last - first - 1)));
  std::vector<std::string> words = WordsOf(rest);
  std::size_t numbers = 0;
  while (numbers < words.size() && IsNumber(words[words.size() - 1 - numbers])) ++numbers;
  // red, green, blue and perhaps how opaque
  if (numbers >= 3 && numbers < words.size()) words.resize(words.size() - numbers);
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "" : " ") + word;
  return std::string(Trimmed(name, " \t'"));
}

/// "5 liver", "5: liver", "5, liver, 255, 0, 0", "liver = 5", "liver: 5".
std::optional<std::pair<std::string, int>> ReadEntry(std::string_view line) {
  line = Trimmed(line, " \t,;{}");
  if (line.starts_with('"')) {
    // "liver": 5, as a dictionary in a program has it
    const std::size_t end = line.find('"', 1);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view first = line.substr(1, end - 1), rest = Trimmed(line.substr(end + 1), " \t:=,;\"");
    if (const auto label = ParseLabel(rest)) return std::pair{std::string(first), *label};
    if (const auto label = ParseLabel(first); label && !rest.empty())
      return std::pair{std::string(rest), *label};
    return std::nullopt;
  }
  const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
  if (digits > 0) {
    const auto label = ParseLabel(line.substr(0, digits));
    if (!label || digits == line.size() ||
        std::string_view(" \t:=,;").find(line[digits]) == std::string_view::npos)
      return std::nullopt;
    std::string rest(Trimmed(line.substr(digits), " \t:=,;"));
    const bool is_quoted = rest.find('"') != std::string::npos;
    if (!is_quoted)
      std::replace_if(
          rest.begin(), rest.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    const std::string name = NameIn(rest);
    if (name.empty() || IsNumber(name)) return std::nullopt;
    return std::pair{name, *label};
  }
  const std::size_t between = line.find_last_of(" \t:=,;");
  if (between == std::string_view::npos) return std::nullopt;
  const auto label = ParseLabel(line.substr(between + 1));
  const std::string name(Trimmed(line.substr(0, between), " \t:=,;'"));
  // "Segment 5" names no segment, and a name with a number behind it is no entry
  const bool is_sure =
      line.find_first_of(":=,;\t", name.size()) != std::string_view::npos || WordsOf(name).size() == 1;
  if (!label || name.empty() || !is_sure) return std::nullopt;
  return std::pair{name, *label};
}

base::Result<Table> ReadTextTable(std::string_view text, const std::string& source) {
  const std::vector<Line> lines = LinesOf(text);
  if (lines.empty()) return Table{};
  if (const auto columns = FindColumns(lines.front().text)) return ReadColumns(lines, *columns, source);
  Names names;
  for (const Line& line : lines) {
    if (Trimmed(line.text, " \t{},").empty()) continue;
    const auto entry = ReadEntry(line.text);
    if (!entry) {
      const bool is_header = &line == &lines.front() && lines.size() > 1 && ReadEntry(lines[1].text);
      if (is_header && (line.text.find_first_of(",;\t") != std::string::npos || line.text.ends_with(':')))
        continue;
      const bool has_columns =
          &line == &lines.front() && line.text.find_first_of(",;\t") != std::string::npos;
      return NoEntry(source, line,
                     has_columns ? "is no header with a column of labels (label, index, value) and one of "
                                   "names (name, structure)"
                                 : "is no label and its name");
    }
    names.push_back(*entry);
  }
  return Table{std::move(names)};
}

}  // namespace

base::Result<LabelTable> ReadLabelNames(const std::filesystem::path& path) {
  auto read = host::ReadFile(path, kMostBytes);
  if (!read.ok()) return read.error();
  const std::string source = host::Printable(path.string());
  std::string text = std::move(*read);
  // byte order marks, as Excel and the Windows editor write them
  const bool is_little = text.starts_with("\xff\xfe"), is_big = text.starts_with("\xfe\xff");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (is_little || is_big) {
    const auto utf8 = FromUtf16(std::string_view(text).substr(2), is_big);
    if (!utf8) return Error{ErrorCode::kLabelsMismatch, source + ": it is damaged UTF-16; save it as UTF-8"};
    text = *utf8;
  }
  if (const std::string other = DescribeOther(text); !other.empty())
    return Error{ErrorCode::kLabelsMismatch, source + ": " + other};
  const std::string_view begin = Trimmed(text);
  const bool is_json = begin.starts_with('{') || begin.starts_with('[');
  auto table = is_json ? ReadJsonTable(text, source) : ReadTextTable(text, source);
  if (!table.ok()) return table.error();
  Names& names = table->names;
  std::erase_if(names, [](const auto& entry) { return entry.second == 0; });
  if (names.empty()) return Error{ErrorCode::kLabelsMismatch, source + ": it names no label" + kHow};
  std::map<int, std::string> seen;
  for (const auto& [name, label] : names) {
    const auto [other, is_new] = seen.emplace(label, name);
    if (is_new || table->has_regions) continue;
    return TwoNames(source, label, other->second, name);
  }
  return LabelTable{std::move(names), std::move(table->codes)};
}

}  // namespace trocar::anatomy
