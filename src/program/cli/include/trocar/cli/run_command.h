// SPDX-License-Identifier: Apache-2.0
/// \file run_command.h  The `trocar` command, all of it in one program: for tests, and for what lists commands.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trocar::cli {

/// Gets a text and returns what is to stand in its place.
using TextVisitor = std::function<std::string(const std::string&)>;

/// Visits every text that `trocar ... --help` prints, in English, for the test that each has been translated.
void ListHelpTexts(const TextVisitor& visit);

/// The words of every command below `trocar`, its own none first: {}, {"store"}, {"store", "add"}, ...
std::vector<std::vector<std::string>> ListCommands();

/// A place of a command line.
struct CommandOption {
  std::string name;  ///< "--output"; of a positional one what its help calls it
  std::string type;  ///< "FILE"; empty: it takes no value
  bool is_positional = false;
  bool is_required = false;
};
/// The places of one command, in the order in which positional ones stand.
/// \param words  one of ListCommands
std::vector<CommandOption> ListOptions(const std::vector<std::string>& words);

/// Reads the command line, runs one subcommand, prints.
///
/// \return exit status: 0 good; 1 something failed ("trocar: E-... message" on standard error); 2 wrong usage
int RunCommand(int argc, char** argv);

}  // namespace trocar::cli
