// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "command.h"
#include "trocar/cli/parts.h"

namespace trocar::cli {

std::span<const Command> SimulatorCommands() {
  static constexpr auto kCommands = std::to_array<Command>({{"window", AddWindowCommand},
                                                            {"demo", AddDemoCommand},
                                                            {"pictures", AddPicturesCommand},
                                                            {"simulate", AddSimulateCommand},
                                                            {"replay", AddReplayCommand},
                                                            {"coach", AddCoachCommand},
                                                            {"metrics", AddMetricsCommand},
                                                            {"record", AddRecordCommand},
                                                            {"devices", AddDevicesCommand},
                                                            {"doctor", AddDoctorCommand},
                                                            {"errors", AddErrorsCommand}});
  return kCommands;
}

}  // namespace trocar::cli
