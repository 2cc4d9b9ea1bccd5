// SPDX-License-Identifier: Apache-2.0
/// \file process.h  Runs programs and keeps what they print.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "trocar_test/temporary_folder.h"

namespace trocar::test {

struct ProcessResult {
  int status = -1;  ///< as Process::Status()
  std::string out, err;
};

/// A program that runs beside the test, and ends with this at the latest.
class Process {
 public:
  /// \param words        the program first
  /// \param environment  "NAME=value" lines added to this process's environment, or put in their place
  explicit Process(std::vector<std::string> words, const std::vector<std::string>& environment = {}) {
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
    for (const auto& [file, name] : {std::pair{STDOUT_FILENO, "out"}, std::pair{STDERR_FILENO, "err"}}) {
      const std::string path = folder_.Path() / name;
      ::posix_spawn_file_actions_addopen(&actions, file, path.c_str(), O_WRONLY | O_CREAT, 0600);
    }
    is_running_ = ::posix_spawn(&process_, argv[0], &actions, nullptr, argv.data(), envp.data()) == 0;
    ::posix_spawn_file_actions_destroy(&actions);
  }
  ~Process() {
    if (HasEnded()) return;
    ::kill(process_, SIGTERM);
    Wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool HasEnded() {
    if (is_running_) Collect(WNOHANG);
    return !is_running_;
  }
  void Wait() {
    if (is_running_) Collect(0);
  }
  /// While it has not ended.
  pid_t Id() const { return process_; }
  void Signal(int signal) {
    if (is_running_) ::kill(process_, signal);
  }
  /// Exit status once it has ended; 128 + signal when a signal ended it; -1 when it did not start.
  int Status() const { return status_; }
  /// What it has printed so far.
  std::string Out() const { return Read("out"); }
  std::string Err() const { return Read("err"); }

 private:
  void Collect(int options) {
    int status = 0;
    const pid_t found = ::waitpid(process_, &status, options);
    if (found == 0) return;
    is_running_ = false;
    if (found == process_) status_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  std::string Read(const char* name) const {
    std::ifstream file(folder_.Path() / name, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
  pid_t process_ = -1;
  bool is_running_ = false;
  int status_ = -1;
};

/// Runs a program to its end; parameters as of Process.
inline ProcessResult RunProcess(std::vector<std::string> words,
                                const std::vector<std::string>& environment = {}) {
  Process process(std::move(words), environment);
  process.Wait();
  return {process.Status(), process.Out(), process.Err()};
}

}  // namespace trocar::test
