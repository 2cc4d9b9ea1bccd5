// SPDX-License-Identifier: Apache-2.0
#include "find_doors.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "trocar/core/safe_file.h"

namespace trocar::json_doors {
namespace {

namespace fs = std::filesystem;

/// Without what stands behind "//".
std::string CodeOf(const std::string& line) {
  return line.substr(0, line.find("//"));
}

/// The name of the function whose definition begins with this line, or nothing: clang-format writes them at the edge.
std::string FunctionOf(const std::string& line) {
  static const std::regex definition(R"(^[A-Za-z].*?([A-Za-z_~][A-Za-z_0-9:]*)\()");
  static const std::regex other(
      R"(^(namespace|using|static_assert|class|struct|return|template|extern)\b.*)");
  std::smatch found;
  if (std::regex_match(line, other) || !std::regex_search(line, found, definition)) return {};
  return found[1];
}

}  // namespace

std::set<std::string> FindDoors(const std::string& name, std::string_view source) {
  static const std::regex call(R"(\b(ParseJson|ParseJsonEvents)\s*<|\bJsonDocument::(Parse|Read)\s*\()");
  std::set<std::string> doors;
  std::istringstream lines{std::string(source)};
  std::string line, function;
  while (std::getline(lines, line)) {
    if (const std::string begun = FunctionOf(line); !begun.empty()) function = begun;
    if (std::regex_search(CodeOf(line), call)) doors.insert(name + " " + function);
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
    if (std::regex_search(CodeOf(line), parser))
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
    const auto text = core::ReadFile(entry.path());
    sources.emplace_back(name, text.ok() ? *text : std::string());
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

}  // namespace trocar::json_doors
