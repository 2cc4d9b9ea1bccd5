// SPDX-License-Identifier: Apache-2.0
/// \file task_names.h  Names in a task file: what they mean, and entries that are repeated for several items.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "trocar/host/json.h"

namespace trocar::files {

/// Replaces {each} by the item that a repeated goal or error stands for.
inline std::string Fill(std::string text, const std::string& item) {
  constexpr std::string_view kEach = "{each}";
  for (std::size_t at = text.find(kEach); at != std::string::npos; at = text.find(kEach, at + item.size()))
    text.replace(at, kEach.size(), item);
  return text;
}

template <typename Things>
std::string JoinNames(const Things& things) {
  std::string all;
  for (const auto& one : things) all += (all.empty() ? "" : ", ") + one.name;
  return all.empty() ? "none" : all;
}

template <typename Things>
int FindName(const host::JsonView& view, const Things& things, const std::string& name, const char* what) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == name) return static_cast<int>(i);
  }
  view.Complain("there is no " + std::string(what) + " \"" + name + "\"; known are " + JoinNames(things),
                base::ErrorCode::kUnknownName);
  return -1;
}

/// The items that an entry is repeated for; one nameless item without "for_each".
inline std::vector<std::string> ReadItems(const host::JsonView& view) {
  if (!view.Has("for_each")) return {""};
  std::vector<std::string> items;
  for (const host::JsonView& item : view.Array("for_each")) items.push_back(item.AsText());
  if (items.empty()) view.Complain("for_each is empty", base::ErrorCode::kSceneInvalid);
  return items;
}

}  // namespace trocar::files
