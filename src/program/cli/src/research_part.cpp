// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "command.h"
#include "trocar/cli/parts.h"

namespace trocar::cli {

std::span<const Command> ResearchCommands() {
  static constexpr auto kCommands = std::to_array<Command>({{"dataset", AddDatasetCommand},
                                                            {"study", AddStudyCommand},
                                                            {"bench", AddBenchCommand},
                                                            {"reproduce", AddReproduceCommand}});
  return kCommands;
}

}  // namespace trocar::cli
