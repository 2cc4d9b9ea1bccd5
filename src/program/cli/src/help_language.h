// SPDX-License-Identifier: Apache-2.0
/// \file help_language.h  Puts the help of all commands into the person's language.
#pragma once

#include "trocar/cli/run_command.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
}

namespace trocar::cli {

/// Replaces every text of the command's help, and of the commands below it, by what the visitor returns.
void VisitHelpTexts(CLI::App& app, const TextVisitor& visit);

/// Puts texts and CLI11's own words into the language in use; does nothing in English.
void TranslateHelp(CLI::App& app);

}  // namespace trocar::cli
