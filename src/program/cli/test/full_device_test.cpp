// SPDX-License-Identifier: Apache-2.0
// What is printed and does not arrive is no success. The list of commands is the program's own: a new one joins it by itself.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "trocar/cli/run_command.h"

namespace trocar::cli {
namespace {

struct Ended {
  int status = 0;
  std::string err;
};

/// Runs `trocar WORDS` with its output on a device.
Ended RunOnto(const char* device, std::vector<std::string> words) {
  words.insert(words.begin(), "trocar");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  std::fflush(stdout);
  const int before = ::dup(STDOUT_FILENO);
  const int output = ::open(device, O_WRONLY | O_CLOEXEC);
  EXPECT_GE(output, 0);
  ::dup2(output, STDOUT_FILENO);
  testing::internal::CaptureStderr();
  const int status = RunCommand(static_cast<int>(argv.size()), argv.data());
  const std::string err = testing::internal::GetCapturedStderr();
  std::fflush(stdout);
  std::clearerr(stdout);
  ::dup2(before, STDOUT_FILENO);
  ::close(before);
  ::close(output);
  return {status, err};
}

TEST(FullDevice, IsNoticedByEveryCommand) {
  const auto commands = ListCommands();
  ASSERT_GT(commands.size(), 60u);
  for (std::vector<std::string> words : commands) {
    std::string command;
    for (const std::string& word : words) command += word + " ";
    words.push_back("--help");
    const Ended full = RunOnto("/dev/full", words);
    EXPECT_NE(full.status, 0) << command;
    EXPECT_THAT(full.err, testing::HasSubstr("standard output")) << command;
    EXPECT_EQ(RunOnto("/dev/null", words).status, 0) << command << "(the control)";
  }
}

TEST(FullDevice, IsNoticedByWhatCommandsPrint) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--version"},
                                             {"errors"},
                                             {"errors", "--markdown"},
                                             {"play", "--list"},
                                             {"metrics", "--list"},
                                             {"course", "list"},
                                             {"course", "show", "basic-skills"}}) {
    const Ended full = RunOnto("/dev/full", words), good = RunOnto("/dev/null", words);
    if (good.status != 0) ADD_FAILURE() << words[0] << ": " << good.err;
    EXPECT_NE(full.status, 0) << words[0];
    EXPECT_THAT(full.err, testing::HasSubstr("E-IO-")) << words[0];
  }
}

}  // namespace
}  // namespace trocar::cli
