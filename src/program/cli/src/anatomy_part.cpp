// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "command.h"
#include "trocar/cli/parts.h"

namespace trocar::cli {

std::span<const Command> AnatomyCommands() {
  static constexpr auto kCommands = std::to_array<Command>({{"anatomy", AddAnatomyCommand}});
  return kCommands;
}

}  // namespace trocar::cli
