// SPDX-License-Identifier: Apache-2.0
/// \file find_doors.h  Where the sources take JSON, found by reading them.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::json_doors {

/// Functions of a source that call core's reader: "src/judge/report/src/rating.cpp ReadRating".
std::set<std::string> FindDoors(const std::string& name, std::string_view source);

/// Lines of a source that parse JSON with the library itself: "src/a.cpp:12: json::parse(text)".
std::vector<std::string> FindOwnParsers(const std::string& name, std::string_view source);

/// Every .h and .cpp of `folder` below `root`, but for tests: its name and its text.
std::vector<std::pair<std::string, std::string>> ReadSources(const std::filesystem::path& root,
                                                             const std::string& folder);

}  // namespace trocar::json_doors
