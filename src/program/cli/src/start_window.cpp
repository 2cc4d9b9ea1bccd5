// SPDX-License-Identifier: Apache-2.0
#include "start_window.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "start_program.h"
#include "trocar/host/program.h"

namespace trocar::cli {

base::Error StartWindow(const std::vector<std::string>& arguments) {
  const std::filesystem::path program = host::FindMainProgram("trocar-window");
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const int why = ReplaceProgram(program, std::move(words));
  if (why == ENOENT) {
    return base::Error{base::ErrorCode::kWindowMissing,
                       "trocar-window is not beside this program: build it too (ninja programs, with "
                       "TROCAR_BUILD_WINDOW=ON), or "
                       "use trocar demo, which needs no window"};
  }
  return base::Error{base::ErrorCode::kWindowMissing,
                     std::string("trocar-window does not start: ") + std::strerror(why) + "; build it again"};
}

}  // namespace trocar::cli
