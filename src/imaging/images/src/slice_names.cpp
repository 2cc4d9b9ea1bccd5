// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/slice_names.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

#include "trocar/host/printable.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;

constexpr std::size_t kMostDigits = 7;
constexpr int kLargestNumber = 1000000;  // as in control-point files
constexpr std::size_t kMostNamed = 8;    // in a message

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

/// "image-", 430, 4 digits, ".jpeg"
struct NumberedName {
  std::string prefix, suffix;
  int number = 0;
  std::size_t digits = 0;
};

std::optional<NumberedName> SplitName(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  std::size_t end = dot == std::string::npos ? name.size() : dot;
  while (end > 0 && !IsDigit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && IsDigit(name[begin - 1])) --begin;
  if (begin == end || end - begin > kMostDigits) return std::nullopt;
  NumberedName split{name.substr(0, begin), name.substr(end), 0, end - begin};
  std::from_chars(name.data() + begin, name.data() + end, split.number);
  if (split.number > kLargestNumber) return std::nullopt;
  return split;
}

/// Files whose names differ in their number only.
struct Stack {
  std::map<int, std::string> files;
  std::size_t fewest_digits = 99, most_digits = 0;
  std::optional<std::pair<std::string, std::string>> doubled;  // two names of one number
};

std::string MakePattern(const std::pair<std::string, std::string>& affixes, const Stack& stack) {
  // numbers of one width are padded; "9, 10" is not
  const bool is_padded = stack.fewest_digits == stack.most_digits && stack.most_digits > 1;
  return affixes.first + (is_padded ? "{slice:0" + std::to_string(stack.most_digits) + "}" : "{slice}") +
         affixes.second;
}

}  // namespace

bool IsPictureName(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return false;
  std::string extension(name.substr(dot));
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png" || extension == ".tif" ||
         extension == ".tiff";
}

std::string FormatImageName(std::string_view pattern, int slice) {
  const auto open = pattern.find("{slice");
  const auto close = pattern.find('}', open == std::string_view::npos ? 0 : open);
  if (open == std::string_view::npos || close == std::string_view::npos) return std::string(pattern);
  const std::string_view inside = pattern.substr(open + 6, close - open - 6);  // "" or ":04"
  std::size_t digits = 0;
  for (const char c : inside) {
    if (std::isdigit(static_cast<unsigned char>(c)))
      digits = std::min<std::size_t>(digits * 10 + (c - '0'), 12);
  }
  std::string number = std::to_string(slice);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return std::string(pattern.substr(0, open)) + number + std::string(pattern.substr(close + 1));
}

base::Result<NamedSlices> FindNamedSlices(std::span<const std::string> names, const std::string& pattern) {
  std::map<std::pair<std::string, std::string>, Stack> stacks;
  for (const std::string& name : names) {
    if (pattern.empty() && !IsPictureName(name)) continue;
    const auto split = SplitName(name);
    if (!split) continue;
    if (!pattern.empty() && FormatImageName(pattern, split->number) != name) continue;
    Stack& stack = stacks[{split->prefix, split->suffix}];
    const auto [other, is_new] = stack.files.emplace(split->number, name);
    if (!is_new && !stack.doubled) stack.doubled = std::minmax(other->second, name);
    stack.fewest_digits = std::min(stack.fewest_digits, split->digits);
    stack.most_digits = std::max(stack.most_digits, split->digits);
  }
  if (stacks.empty()) {
    return Error{ErrorCode::kImageSliceMissing,
                 pattern.empty()
                     ? std::string("there are no numbered pictures (JPEG, PNG or TIFF) in the folder")
                     : "no file in the folder is named like " + host::Printable(pattern)};
  }
  if (stacks.size() > 1) {
    std::string found;
    std::size_t told = 0;
    for (const auto& [affixes, stack] : stacks) {
      if (++told > kMostNamed) break;
      found += (found.empty() ? "" : ", ") + host::Printable(MakePattern(affixes, stack)) + " (" +
               std::to_string(stack.files.size()) + ")";
    }
    return Error{ErrorCode::kImageSeriesMixed, "the folder holds " + std::to_string(stacks.size()) +
                                                   " stacks of pictures: " + found +
                                                   "; choose one with --pattern"};
  }
  auto& [affixes, stack] = *stacks.begin();
  if (stack.doubled) {
    return Error{ErrorCode::kImageSeriesUneven, host::Printable(stack.doubled->first) + " and " +
                                                    host::Printable(stack.doubled->second) +
                                                    " have the same number; remove one"};
  }
  NamedSlices result;
  result.pattern = pattern.empty() ? MakePattern(affixes, stack) : pattern;
  result.ignored = names.size() - stack.files.size();
  result.files = std::move(stack.files);
  return result;
}

base::Result<int> CheckSliceNumbers(std::span<const int> numbers) {
  if (numbers.size() < 2) return 1;
  int step = numbers[1] - numbers[0];
  for (std::size_t i = 1; i < numbers.size(); ++i) step = std::min(step, numbers[i] - numbers[i - 1]);
  // two slices with a hole between them are a gap, not a coarse stack
  if (numbers.size() == 2) step = 1;
  std::string missing;
  std::size_t count = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] - numbers[i - 1] == step) continue;
    const int first = numbers[i - 1] + step;
    const int last = numbers[i] - step;
    if (last < first || (numbers[i] - numbers[i - 1]) % step != 0) {
      return Error{ErrorCode::kImageSeriesUneven, "slice numbers go from " + std::to_string(numbers[i - 1]) +
                                                      " to " + std::to_string(numbers[i]) +
                                                      ", elsewhere in steps of " + std::to_string(step) +
                                                      "; complete the stack"};
    }
    if (++count > kMostNamed) continue;
    missing += (missing.empty() ? "" : ", ") + std::to_string(first);
    if (last > first) missing += " to " + std::to_string(last);
  }
  if (count == 0) return step;
  if (count > kMostNamed) missing += " and more";
  return Error{ErrorCode::kImageSeriesGap, "slices are missing: " + missing +
                                               "; complete the stack, or remove the slices on one side of "
                                               "each gap"};
}

}  // namespace trocar::images
