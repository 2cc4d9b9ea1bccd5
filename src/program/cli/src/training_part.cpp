// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "command.h"
#include "trocar/cli/parts.h"

namespace trocar::cli {

std::span<const Command> TrainingCommands() {
  static constexpr auto kCommands = std::to_array<Command>({{"play", AddPlayCommand},
                                                            {"report", AddReportCommand},
                                                            {"rating", AddRatingCommand},
                                                            {"xapi", AddXapiCommand},
                                                            {"course", AddCourseCommand},
                                                            {"levels", AddLevelsCommand},
                                                            {"exam", AddExamCommand},
                                                            {"certificate", AddCertificateCommand},
                                                            {"store", AddStoreCommand}});
  return kCommands;
}

}  // namespace trocar::cli
