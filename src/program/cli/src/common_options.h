// SPDX-License-Identifier: Apache-2.0
/// \file common_options.h  Options that several commands take: each has one name, range and placeholder, and words that fit most.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
class Option;
}  // namespace CLI

namespace trocar::cli {

/// --threads T, 1 to 256.
/// \param[in,out] threads  the default; lives as long as the command, as what the other options fill
CLI::Option* AddThreadsOption(CLI::App& command, int& threads,
                              const char* about = "Of the solver; the result is the same for any number");
/// --json
CLI::Option* AddJsonFlag(CLI::App& command, bool& is_json, const char* about = "Machine-readable");
/// --size WxH, as ReadSize() takes it.
CLI::Option* AddSizeOption(CLI::App& command, std::string& size,
                           const char* about = "Of pictures and video [pixels]");
/// --cache DIR
CLI::Option* AddCacheOption(
    CLI::App& command, std::string& cache,
    const char* about = "Folder for the patient; the user's cache folder if not given");

}  // namespace trocar::cli
