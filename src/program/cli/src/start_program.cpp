// SPDX-License-Identifier: Apache-2.0
#include "start_program.h"

#include <unistd.h>

#include <cerrno>

namespace trocar::cli {

int ReplaceProgram(const std::filesystem::path& program, std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return errno;
}

}  // namespace trocar::cli
