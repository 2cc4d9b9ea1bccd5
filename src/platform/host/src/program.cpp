// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/program.h"

#include <system_error>

namespace trocar::host {

namespace fs = std::filesystem;

namespace {

/// In this folder of an installation, else beside the running program.
fs::path FindInstalled(const char* folder, std::string_view name) {
  std::error_code failure;
  fs::path installed = FindInstallationFolder() / folder / name;
  return fs::exists(installed, failure) ? installed : FindProgramFolder() / name;
}

}  // namespace

fs::path FindProgram() {
  std::error_code failure;
  return fs::read_symlink("/proc/self/exe", failure);  // empty where it fails
}

fs::path FindProgramFolder() {
  const fs::path program = FindProgram();
  return program.empty() ? fs::path(".") : program.parent_path();
}

fs::path FindInstallationFolder() {
  const fs::path folder = FindProgramFolder(), above = folder.parent_path();
  return folder.filename() == "trocar" && above.filename() == "libexec" ? above.parent_path() : above;
}

fs::path FindMainProgram(std::string_view name) {
  return FindInstalled("bin", name);
}

fs::path FindCompanionProgram(std::string_view name) {
  return FindInstalled("libexec/trocar", name);
}

}  // namespace trocar::host
