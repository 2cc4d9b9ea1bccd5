// SPDX-License-Identifier: Apache-2.0
#include "header_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace trocar::images::import {

using core::ErrorCode;

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
    throw Failure{ErrorCode::kImageTooLarge, std::string(field) + " in its header is beyond any file's size"};
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    throw Failure{ErrorCode::kImageUndecodable, std::string(field) + " in its header is no whole number"};
  return number;
}

std::vector<double> ParseNumbers(std::string_view text, const char* field) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(text)) numbers.push_back(ParseNumber(word, field));
  return numbers;
}

void SetSides(const std::vector<std::int64_t>& sides, const Job& job, ImageHeader& header) {
  std::uint32_t* const given[] = {&header.width, &header.height, &header.depth};
  header.depth = 1;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] < 1)
      throw Failure{ErrorCode::kImageUndecodable, "one of its sides has no voxel or a negative number"};
    if (i >= 3) {
      if (sides[i] != 1)
        throw Failure{ErrorCode::kImageUnsupported, "it has more than three dimensions; extract one volume"};
      continue;
    }
    if (sides[i] > static_cast<std::int64_t>(job.request.most_side)) {
      throw Failure{ErrorCode::kImageTooLarge,
                    "one of its sides is longer than " + std::to_string(job.request.most_side) + " voxels"};
    }
    *given[i] = static_cast<std::uint32_t>(sides[i]);
  }
}

bool FindDataFile(const Job& job, std::string_view name, ImageHeader& header) {
  if (name.empty() || name.size() >= sizeof(header.data_file))
    throw Failure{ErrorCode::kImagePathUnsafe, "the name of its data file is empty or too long"};
  const bool is_plain = name.find('/') == std::string_view::npos &&
                        name.find('\\') == std::string_view::npos &&
                        name.find('\0') == std::string_view::npos && name != "." && name != "..";
  if (!is_plain) throw Failure{ErrorCode::kImagePathUnsafe, "it names a data file outside its own folder"};
  if (name.find('%') != std::string_view::npos)
    throw Failure{ErrorCode::kImageUnsupported, "its samples are spread over several files"};
  name.copy(header.data_file, sizeof(header.data_file) - 1);
  return job.data_file.has_value();
}

}  // namespace trocar::images::import
