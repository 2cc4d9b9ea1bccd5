// SPDX-License-Identifier: Apache-2.0
#include "start_window.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "trocar/host/program.h"

namespace trocar::cli {

base::Error StartWindow(const std::vector<std::string>& arguments) {
  const std::filesystem::path program = host::FindProgramFolder() / "trocar-window";
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  if (errno == ENOENT) {
    return base::Error{base::ErrorCode::kWindowMissing,
                       "trocar-window is not beside this program: build it too (ninja programs, with "
                       "TROCAR_BUILD_WINDOW=ON), or "
                       "use trocar demo, which needs no window"};
  }
  return base::Error{base::ErrorCode::kWindowMissing, std::string("trocar-window does not start: ") +
                                                          std::strerror(errno) + "; build it again"};
}

}  // namespace trocar::cli
