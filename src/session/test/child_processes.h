// SPDX-License-Identifier: Apache-2.0
/// \file child_processes.h  The helper processes that a test has started, found by their command line.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace trocar::session {

/// Child process of this one that was started with so an option; 0: none.
inline pid_t FindChild(const std::string& option) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::ifstream line("/proc/" + std::to_string(child) + "/cmdline");
      const std::string words((std::istreambuf_iterator<char>(line)), {});
      if (words.find(option) != std::string::npos) return child;
    }
  }
  return 0;
}

}  // namespace trocar::session
