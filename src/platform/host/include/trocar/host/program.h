// SPDX-License-Identifier: Apache-2.0
/// \file program.h  The running program, and those that come with it.
#pragma once

#include <filesystem>
#include <string_view>

namespace trocar::host {

/// File of the running program; empty where the system does not say.
std::filesystem::path FindProgram();
/// Folder of the running program; "." where the system does not say.
std::filesystem::path FindProgramFolder();
/// Folder of an installation in which bin/, libexec/trocar/ and share/ lie, seen from the running program in either of the first two.
std::filesystem::path FindInstallationFolder();
/// A program that a person starts: in bin/ of an installation, else beside the running one.
std::filesystem::path FindMainProgram(std::string_view name);
/// A program that only other programs start: in libexec/trocar/ of an installation, else beside the running one.
std::filesystem::path FindCompanionProgram(std::string_view name);

}  // namespace trocar::host
