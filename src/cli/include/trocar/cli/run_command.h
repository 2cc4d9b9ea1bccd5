// SPDX-License-Identifier: Apache-2.0
/// \file run_command.h  The `trocar` command.
#pragma once

namespace trocar::cli {

/// Reads the command line, runs one subcommand, prints.
///
/// \return exit status: 0 good; 1 something failed ("trocar: E-... message" on standard error); 2 wrong usage
int RunCommand(int argc, char** argv);

}  // namespace trocar::cli
