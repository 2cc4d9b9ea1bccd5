// SPDX-License-Identifier: Apache-2.0
/// \file start_program.h  One program of Trocar that becomes another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace trocar::cli {

/// Becomes another program; comes back only where it does not start.
///
/// \param words  its command line, the name that it is called by first
/// \return why, as in errno: ENOENT where there is no such program
int ReplaceProgram(const std::filesystem::path& program, std::vector<std::string> words);

}  // namespace trocar::cli
