// SPDX-License-Identifier: Apache-2.0
/// \file run_trocar.h  The command line inside a test, with what it printed.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "trocar/cli/run_command.h"

namespace trocar::cli {

struct Printed {
  int status = 0;
  std::string out, err;
};

/// \param words  what stands behind "trocar"
inline Printed RunTrocar(std::vector<std::string> words) {
  words.insert(words.begin(), "trocar");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status = RunCommand(static_cast<int>(argv.size()), argv.data());
  std::fflush(stdout);
  const std::string out = testing::internal::GetCapturedStdout();
  return {status, out, testing::internal::GetCapturedStderr()};
}

}  // namespace trocar::cli
