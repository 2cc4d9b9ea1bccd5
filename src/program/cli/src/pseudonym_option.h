// SPDX-License-Identifier: Apache-2.0
/// \file pseudonym_option.h  Options that take a pseudonym.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
class Option;
}  // namespace CLI

namespace trocar::cli {

/// \param name          "--person"
/// \param[out] person  lives as long as the command
/// \return the option, which refuses what is no pseudonym
CLI::Option* AddPseudonymOption(CLI::App& command, const char* name, std::string& person, const char* about);

}  // namespace trocar::cli
