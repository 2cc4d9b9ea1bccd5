// SPDX-License-Identifier: Apache-2.0
// Each command lies in one program, which is that of the list, of the help and of the build.
#include "trocar/cli/parts.h"

#include <gtest/gtest.h>

#include <map>
#include <span>
#include <sstream>
#include <string>

#include "command_list.h"

namespace trocar::cli {
namespace {

using Programs = std::map<std::string, std::string>;  // of each command

Programs ListParts() {
  const std::map<std::string, std::span<const Command>> parts = {{"trocar", SimulatorCommands()},
                                                                 {"trocar-training", TrainingCommands()},
                                                                 {"trocar-anatomy", AnatomyCommands()},
                                                                 {"trocar-research", ResearchCommands()}};
  Programs programs;
  for (const auto& [program, commands] : parts) {
    for (const Command& command : commands)
      EXPECT_TRUE(programs.emplace(command.name, program).second)
          << command.name << " stands in two programs";
  }
  return programs;
}

TEST(Parts, HaveTheCommandsOfTheList) {
  Programs listed;
  for (const ListedCommand& command : ListedCommands()) listed.emplace(command.name, command.program);
  EXPECT_EQ(ListParts(), listed);
}

// ninja command-NAME, which ./run asks for, builds the program that has the command
TEST(Parts, AreBuiltByTheTargetsOfTheirCommands) {
  Programs built;
  std::istringstream pairs(TROCAR_COMMAND_PROGRAMS);
  for (std::string pair; pairs >> pair;)
    built.emplace(pair.substr(0, pair.find('=')), pair.substr(pair.find('=') + 1));
  EXPECT_EQ(built, ListParts());
}

}  // namespace
}  // namespace trocar::cli
