// SPDX-License-Identifier: Apache-2.0
#include "label_names.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "trocar/core/json.h"
#include "trocar/core/printable.h"
#include "trocar/core/safe_file.h"
#include "trocar/images/image_stack.h"

namespace trocar::anatomy {
namespace {

using core::Error;
using core::ErrorCode;

using Names = std::vector<std::pair<std::string, int>>;

constexpr std::size_t kMostBytes = 1u << 20;

std::optional<int> ParseLabel(std::string_view text) {
  int label = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), label);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || label < 0) return std::nullopt;
  return label;
}

core::Result<Names> ReadJsonTable(const std::string& text, const std::string& source) {
  const auto document = core::JsonDocument::Parse(text, source);
  if (!document.ok()) return document.error();
  core::JsonView table = document->Root();
  if (table.Has("labels")) table = table.Object("labels");
  const std::vector<std::string> keys = table.Keys();
  const bool is_by_label = std::all_of(keys.begin(), keys.end(),
                                       [](const std::string& key) { return ParseLabel(key).has_value(); });
  Names names;
  for (const std::string& key : keys) {
    if (is_by_label)
      names.emplace_back(table.Text(key), *ParseLabel(key));
    else
      names.emplace_back(key, table.Integer(key, {0.0, static_cast<double>(images::kLargestLabel)}));
  }
  if (auto status = document->Check(); !status.ok()) return status.error();
  return names;
}

/// The name in one line behind its label: in quotation marks at the end, or the second word.
std::string NameIn(std::string_view line, std::istringstream& rest) {
  const std::size_t last = line.rfind('"'), first = line.find('"');
  if (first != std::string_view::npos && last > first)
    return std::string(line.substr(first + 1, last - first - 1));
  std::string word;
  rest >> word;
  return word;
}

core::Result<Names> ReadTextTable(const std::string& text, const std::string& source) {
  Names names;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#' || line[begin] == '%' ||
        line.compare(begin, 2, "//") == 0)
      continue;
    std::istringstream words(line);
    std::string first;
    words >> first;
    const auto label = ParseLabel(first);
    const std::string name = label ? NameIn(line, words) : "";
    if (name.empty()) {
      return Error{ErrorCode::kLabelsMismatch, source + ": line " + std::to_string(number) +
                                                   " is no label and its name; write lines like: 5 liver"};
    }
    names.emplace_back(name, *label);
  }
  return names;
}

}  // namespace

core::Result<Names> ReadLabelNames(const std::filesystem::path& path) {
  const auto text = core::ReadFile(path, kMostBytes);
  if (!text.ok()) return text.error();
  const std::string source = core::Printable(path.string());
  const std::size_t begin = text->find_first_not_of(" \t\r\n");
  const bool is_json = begin != std::string::npos && (*text)[begin] == '{';
  auto names = is_json ? ReadJsonTable(*text, source) : ReadTextTable(*text, source);
  if (!names.ok()) return names.error();
  std::erase_if(*names, [](const auto& entry) { return entry.second == 0; });
  std::set<int> seen;
  for (const auto& [name, label] : *names) {
    if (seen.insert(label).second) continue;
    return Error{ErrorCode::kLabelsMismatch,
                 source + ": label " + std::to_string(label) + " has two names; leave one out"};
  }
  if (names->empty())
    return Error{ErrorCode::kLabelsMismatch, source + ": it names no label; write lines like: 5 liver"};
  return names;
}

}  // namespace trocar::anatomy
