// SPDX-License-Identifier: Apache-2.0
#include "header_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

namespace trocar::images::import {
namespace {

using base::ErrorCode;

constexpr std::pair<std::string_view, double> kUnitsMm[] = {{"mm", 1},
                                                            {"millimeter", 1},
                                                            {"millimetre", 1},
                                                            {"millimeters", 1},
                                                            {"millimetres", 1},
                                                            {"cm", 10},
                                                            {"centimeter", 10},
                                                            {"centimetre", 10},
                                                            {"centimeters", 10},
                                                            {"centimetres", 10},
                                                            {"dm", 100},
                                                            {"decimeter", 100},
                                                            {"decimetre", 100},
                                                            {"m", 1000},
                                                            {"meter", 1000},
                                                            {"metre", 1000},
                                                            {"meters", 1000},
                                                            {"metres", 1000},
                                                            {"um", 1e-3},
                                                            {"\xc2\xb5m", 1e-3},
                                                            {"\xce\xbcm", 1e-3},
                                                            {"micron", 1e-3},
                                                            {"microns", 1e-3},
                                                            {"micrometer", 1e-3},
                                                            {"micrometre", 1e-3},
                                                            {"micrometers", 1e-3},
                                                            {"micrometres", 1e-3},
                                                            {"nm", 1e-6},
                                                            {"nanometer", 1e-6},
                                                            {"nanometre", 1e-6},
                                                            {"in", 25.4},
                                                            {"inch", 25.4},
                                                            {"inches", 25.4}};

}  // namespace

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const auto begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::vector<std::string_view> Words(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> words;
  for (;;) {
    const auto begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) return words;
    const auto end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    text.remove_prefix(end);
  }
}

std::vector<std::string> QuotedWords(std::string_view text) {
  std::vector<std::string> words;
  for (text = Trimmed(text); !text.empty(); text = Trimmed(text)) {
    const bool is_quoted = text.front() == '"';
    if (is_quoted) text.remove_prefix(1);
    const auto end = std::min(is_quoted ? text.find('"') : text.find_first_of(" \t"), text.size());
    words.emplace_back(Trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

std::string Shown(std::string_view word) {
  constexpr std::size_t kLongest = 24;
  const bool is_plain =
      !word.empty() && word.size() <= kLongest && std::all_of(word.begin(), word.end(), [](unsigned char c) {
        return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-' || c == ' ');
      });
  return is_plain ? '"' + std::string(word) + '"' : "\"?\"";
}

double ParseNumber(std::string_view text, const char* field) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    throw Failure{ErrorCode::kImageUndecodable, std::string(field) + " in its header is no number"};
  return number;
}

std::int64_t ParseWhole(std::string_view text, const char* field) {
  std::int64_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec == std::errc::result_out_of_range)
    throw Failure{ErrorCode::kImageTooLarge, std::string(field) + " in its header is too large a number"};
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    throw Failure{ErrorCode::kImageUndecodable, std::string(field) + " in its header is no whole number"};
  return number;
}

std::vector<double> ParseNumbers(std::string_view text, const char* field) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(text)) numbers.push_back(ParseNumber(word, field));
  return numbers;
}

std::optional<double> ParseUnitMm(std::string_view unit) {
  const std::string name = LowerCase(Trimmed(unit));
  if (name.find_first_not_of('?') == std::string::npos) return std::nullopt;
  const auto* known = std::find_if(std::begin(kUnitsMm), std::end(kUnitsMm),
                                   [&](const auto& entry) { return entry.first == name; });
  if (known == std::end(kUnitsMm)) {
    throw Failure{ErrorCode::kImageGeometryInvalid, "its unit of length " + Shown(Trimmed(unit)) +
                                                        " is none of mm, cm, dm, m, um, nm and inch"};
  }
  return known->second;
}

void SetSides(const std::vector<std::int64_t>& sides, const Job& job, ImageHeader& header) {
  std::uint32_t* const given[] = {&header.width, &header.height, &header.depth};
  header.height = header.depth = 1;
  std::int64_t volumes = 1;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] < 1)
      throw Failure{ErrorCode::kImageUndecodable, "one of its sides has no voxel or a negative number"};
    if (i >= 3) {
      if (__builtin_mul_overflow(volumes, sides[i], &volumes))
        throw Failure{ErrorCode::kImageTooLarge, "it holds more volumes than can be counted"};
      continue;
    }
    if (sides[i] > static_cast<std::int64_t>(job.request.most_side)) {
      throw Failure{ErrorCode::kImageTooLarge,
                    "one of its sides is longer than " + std::to_string(job.request.most_side) + " voxels"};
    }
    *given[i] = static_cast<std::uint32_t>(sides[i]);
  }
  if (volumes != 1) {
    throw Failure{ErrorCode::kImageUnsupported,
                  "it holds " + std::to_string(volumes) + " volumes; extract one of them"};
  }
}

bool FindDataFile(const Job& job, std::string_view name, ImageHeader& header) {
  if (name.find('\0') != std::string_view::npos)
    throw Failure{ErrorCode::kImagePathUnsafe, "the name of its data file has a zero byte in it"};
  if (name.find('\\') != std::string_view::npos)
    throw Failure{ErrorCode::kImagePathUnsafe, "the path of its data file has a backslash; write it with /"};
  if (name.starts_with('/'))
    throw Failure{ErrorCode::kImagePathUnsafe, "it names its data file by a path from the root on"};
  std::vector<std::string_view> parts;
  for (const std::string_view part : Words(name, "/")) {
    if (part == ".") continue;
    if (part != "..") {
      parts.push_back(part);
      continue;
    }
    if (parts.empty())
      throw Failure{ErrorCode::kImagePathUnsafe, "it names a data file outside its own folder"};
    parts.pop_back();
  }
  std::string path;
  for (const std::string_view part : parts) path += (path.empty() ? "" : "/") + std::string(part);
  if (path.empty()) throw Failure{ErrorCode::kImagePathUnsafe, "it does not name its data file"};
  if (path.size() >= sizeof(header.data_file)) {
    throw Failure{ErrorCode::kImagePathUnsafe, "the path of its data file is longer than " +
                                                   std::to_string(sizeof(header.data_file) - 1) + " bytes"};
  }
  path.copy(header.data_file, sizeof(header.data_file) - 1);
  return job.data_file.has_value();
}

}  // namespace trocar::images::import
