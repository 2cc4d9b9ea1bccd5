// SPDX-License-Identifier: Apache-2.0
/// \file parts.h  The programs that `trocar` is made of, and the commands of each.
///
/// `trocar` itself has what a first picture needs. Every other command lies in a program beside it, which it starts when the
/// command is called: a build of the first picture compiles none of them.
#pragma once

#include <span>
#include <string_view>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
}

namespace trocar::cli {

struct Outcome;

/// A command with its options.
struct Command {
  std::string_view name;                         ///< the first word behind `trocar`
  void (*add)(CLI::App& app, Outcome& outcome);  ///< adds it to the command line
};

/// Of the program `trocar`.
std::span<const Command> SimulatorCommands();
/// Of `trocar-training`: attempts, courses, exams, reports, the training centre's store.
std::span<const Command> TrainingCommands();
/// Of `trocar-anatomy`: making and checking patients.
std::span<const Command> AnatomyCommands();
/// Of `trocar-research`: benchmarks, studies, data sets, the paper's experiments.
std::span<const Command> ResearchCommands();

/// RunCommand() in a program that has only some of the commands. A command of another one replaces this program by that one.
///
/// \param own  commands of this program
/// \return exit status; a program that is not there is an error (kFileMissing)
int RunCommandOf(std::span<const Command> own, int argc, char** argv);

}  // namespace trocar::cli
