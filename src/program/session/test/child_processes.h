// SPDX-License-Identifier: Apache-2.0
/// \file child_processes.h  The helper processes that a test has started, found by their command line.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace trocar::session {

/// Child process of another, or of this one, that was started with so an option; 0: none.
/// \param not_this  is passed over
inline pid_t FindChild(const std::string& option, pid_t parent = 0, pid_t not_this = 0) {
  const std::filesystem::path root = "/proc/" + (parent == 0 ? std::string("self") : std::to_string(parent));
  for (const auto& task : std::filesystem::directory_iterator(root / "task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::ifstream line("/proc/" + std::to_string(child) + "/cmdline");
      std::string words;
      std::getline(line, words);  // empty where it has gone meanwhile
      if (child != not_this && words.find(option) != std::string::npos) return child;
    }
  }
  return 0;
}

}  // namespace trocar::session
