// SPDX-License-Identifier: Apache-2.0
#include "program_folder.h"

#include <system_error>

namespace trocar::cli {

std::filesystem::path FindProgramFolder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  return failure ? std::filesystem::path(".") : program.parent_path();
}

}  // namespace trocar::cli
