// SPDX-License-Identifier: Apache-2.0
/// \file process.h  Runs a program and keeps what it printed.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "trocar_test/temporary_folder.h"

namespace trocar::test {

struct ProcessResult {
  int status = -1;  ///< exit status; 128 + signal when a signal ended it; -1 when it did not start
  std::string out, err;
};

/// Runs `words` (the program first) to its end.
///
/// \param environment  "NAME=value" lines added to this process's environment, or put in their place
inline ProcessResult RunProcess(std::vector<std::string> words,
                                const std::vector<std::string>& environment = {}) {
  const TemporaryFolder folder;
  const std::string out_path = folder.Path() / "out", err_path = folder.Path() / "err";
  std::vector<std::string> variables;
  for (char** entry = ::environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    bool is_replaced = false;
    for (const std::string& other : environment) {
      is_replaced = is_replaced || variable.starts_with(other.substr(0, other.find('=') + 1));
    }
    if (!is_replaced) variables.push_back(variable);
  }
  variables.insert(variables.end(), environment.begin(), environment.end());
  std::vector<char*> argv, envp;
  for (std::string& word : words) argv.push_back(word.data());
  for (std::string& variable : variables) envp.push_back(variable.data());
  argv.push_back(nullptr);
  envp.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_path.c_str(), O_WRONLY | O_CREAT, 0600);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_path.c_str(), O_WRONLY | O_CREAT, 0600);
  pid_t child = 0;
  const int failure = ::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), envp.data());
  ::posix_spawn_file_actions_destroy(&actions);
  ProcessResult result;
  if (failure != 0) return result;
  int status = 0;
  if (::waitpid(child, &status, 0) == child) {
    result.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  const auto read = [](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  };
  result.out = read(out_path);
  result.err = read(err_path);
  return result;
}

}  // namespace trocar::test
