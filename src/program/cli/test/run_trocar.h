// SPDX-License-Identifier: Apache-2.0
/// \file run_trocar.h  The command line inside a test, with what it printed.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trocar/cli/run_command.h"

namespace trocar::cli {

using Json = nlohmann::ordered_json;

inline const std::string kBuiltInPatient =
    std::string(TROCAR_SOURCE_DIR) + "/assets/patients/visible-human-male/patient";

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

/// Exit status of tools/check-schemas.
/// \param arguments  in the shell's words, such as where its output goes
inline int CheckSchemas(const std::string& arguments) {
  const int status =
      std::system(("'" + std::string(TROCAR_SOURCE_DIR) + "/tools/check-schemas' " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace trocar::cli
