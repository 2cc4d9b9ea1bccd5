// SPDX-License-Identifier: Apache-2.0
/// \file command_list.h  Every command of `trocar`, and the program that runs it.
#pragma once

#include <span>
#include <string_view>

namespace trocar::cli {

struct ListedCommand {
  std::string_view name;     ///< the first word behind `trocar`
  std::string_view program;  ///< "trocar", or a program that `trocar` starts for it
  const char* description;   ///< a line of the help, in English
};

/// In the order of the help.
std::span<const ListedCommand> ListedCommands();
/// Null where there is no such command.
const ListedCommand* FindListed(std::string_view name);

}  // namespace trocar::cli
