// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/program.h"

#include <system_error>

namespace trocar::host {

namespace fs = std::filesystem;

fs::path FindProgram() {
  std::error_code failure;
  return fs::read_symlink("/proc/self/exe", failure);  // empty where it fails
}

fs::path FindProgramFolder() {
  const fs::path program = FindProgram();
  return program.empty() ? fs::path(".") : program.parent_path();
}

fs::path FindCompanionProgram(std::string_view name) {
  const fs::path folder = FindProgramFolder();
  std::error_code failure;
  fs::path installed = folder.parent_path() / "libexec/trocar" / name;
  return fs::exists(installed, failure) ? installed : folder / name;
}

}  // namespace trocar::host
