// SPDX-License-Identifier: Apache-2.0
#include "find_doors.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <sstream>

#include "trocar/host/safe_file.h"

namespace trocar::json_doors {
namespace {

namespace fs = std::filesystem;

/// Without what stands behind "//".
std::string CodeOf(const std::string& line) {
  return line.substr(0, line.find("//"));
}

/// The name of the function whose definition begins with this line, or nothing: clang-format writes them at the edge.
std::string FunctionOf(const std::string& line) {
  constexpr std::string_view kOthers[] = {"namespace", "using",  "static_assert", "class",
                                          "struct",    "return", "template",      "extern"};
  if (line.empty() || std::isalpha(static_cast<unsigned char>(line[0])) == 0) return {};
  for (const std::string_view other : kOthers) {
    if (line.starts_with(other)) return {};
  }
  const std::size_t end = line.find('(');
  if (end == std::string::npos) return {};
  std::size_t begin = end;
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '~';
  };
  while (begin > 0 && is_part(line[begin - 1])) --begin;
  return line.substr(begin, end - begin);
}

/// Whether it is worth a closer look: a regular expression takes its time.
bool MentionsJson(const std::string& line) {
  return line.find("json") != std::string::npos || line.find("Json") != std::string::npos ||
         line.find("sax_parse") != std::string::npos;
}

}  // namespace

std::set<std::string> FindDoors(const std::string& name, std::string_view source) {
  static const std::regex call(R"(\b(ParseJson|ParseJsonEvents)\s*<|\bJsonDocument::(Parse|Read)\s*\()");
  std::set<std::string> doors;
  std::istringstream lines{std::string(source)};
  std::string line, function;
  while (std::getline(lines, line)) {
    if (const std::string begun = FunctionOf(line); !begun.empty()) function = begun;
    if (MentionsJson(line) && std::regex_search(CodeOf(line), call)) doors.insert(name + " " + function);
  }
  return doors;
}

std::vector<std::string> FindOwnParsers(const std::string& name, std::string_view source) {
  // from_cbor and the like are other doors to the same values
  static const std::regex parser(
      R"(\b(json|basic_json|ordered_json|Json)::(parse|accept|sax_parse|from_[a-z]+)\b|\bsax_parse\s*\(|"_json\b|)"
      R"(>>\s*\(?\s*[a-z_]*json\b|\b(rapidjson|simdjson|json_tokener|json_parser_|Json::Reader|boost::json)\b)");
  std::vector<std::string> parsers;
  std::istringstream lines{std::string(source)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (MentionsJson(line) && std::regex_search(CodeOf(line), parser))
      parsers.push_back(name + ":" + std::to_string(number) + ": " + line);
  }
  return parsers;
}

std::vector<std::pair<std::string, std::string>> ReadSources(const fs::path& root,
                                                             const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> sources;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
    const fs::path extension = entry.path().extension();
    const std::string name = fs::relative(entry.path(), root).generic_string();
    if ((extension != ".h" && extension != ".cpp") || name.find("/test/") != std::string::npos) continue;
    const auto text = host::ReadFile(entry.path());
    sources.emplace_back(name, text.ok() ? *text : std::string());
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

}  // namespace trocar::json_doors
