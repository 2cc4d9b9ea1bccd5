// SPDX-License-Identifier: Apache-2.0
/// \file command.h  The subcommands. Each lives in a file of its own and adds itself to the command line.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/cli/parts.h"

namespace trocar::device {
struct DeviceStore;
}

namespace trocar::cli {

/// Result of the chosen subcommand.
struct Outcome {
  base::Status status;       ///< an error is printed by RunCommand
  bool has_finding = false;  ///< ran well, and what it found is not good (doctor): exit status 1
};

/// Every command of `trocar` with its line of the help, and options of those that `own` has.
/// \pre `outcome` lives as long as what is returned
std::unique_ptr<CLI::App> MakeCommandLine(std::span<const Command> own, Outcome& outcome);
/// Adds a command with its line of the help (command_list.h).
CLI::App* AddListed(CLI::App& app, std::string_view name);

void AddWindowCommand(CLI::App& app, Outcome& outcome);
void AddDemoCommand(CLI::App& app, Outcome& outcome);
void AddPlayCommand(CLI::App& app, Outcome& outcome);
void AddPicturesCommand(CLI::App& app, Outcome& outcome);
void AddSimulateCommand(CLI::App& app, Outcome& outcome);
void AddReportCommand(CLI::App& app, Outcome& outcome);
void AddRatingCommand(CLI::App& app, Outcome& outcome);
void AddXapiCommand(CLI::App& app, Outcome& outcome);
void AddRecordCommand(CLI::App& app, Outcome& outcome);
void AddReplayCommand(CLI::App& app, Outcome& outcome);
void AddCourseCommand(CLI::App& app, Outcome& outcome);
void AddLevelsCommand(CLI::App& app, Outcome& outcome);
void AddExamCommand(CLI::App& app, Outcome& outcome);
void AddCertificateCommand(CLI::App& app, Outcome& outcome);
void AddCoachCommand(CLI::App& app, Outcome& outcome);
void AddDatasetCommand(CLI::App& app, Outcome& outcome);
void AddStudyCommand(CLI::App& app, Outcome& outcome);
void AddMetricsCommand(CLI::App& app, Outcome& outcome);
void AddStoreCommand(CLI::App& app, Outcome& outcome);
void AddAnatomyCommand(CLI::App& app, Outcome& outcome);
/// Below `trocar anatomy`.
void AddAnatomyGenerateCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyGrowCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyCheckCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyCompleteCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyContoursCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyExportCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyRehearseCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyEditCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyLabelEdgesCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyMeasureCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyPhantomCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyViewCommand(CLI::App& anatomy, Outcome& outcome);
void AddAnatomyImagesCommand(CLI::App& anatomy, Outcome& outcome);
void AddDevicesCommand(CLI::App& app, Outcome& outcome);
/// Below `trocar devices`.
void AddDevicesCalibrateCommand(CLI::App& devices, Outcome& outcome);
void AddDevicesEmulateCommand(CLI::App& devices, Outcome& outcome);
/// The person's settings of devices; where their file is bad, the defaults and a warning.
device::DeviceStore LoadStoreOrWarn();
void AddBenchCommand(CLI::App& app, Outcome& outcome);
void AddReproduceCommand(CLI::App& app, Outcome& outcome);
/// Below `trocar reproduce`.
void AddReportCardCommand(CLI::App& reproduce, Outcome& outcome);
void AddDoctorCommand(CLI::App& app, Outcome& outcome);
void AddErrorsCommand(CLI::App& app, Outcome& outcome);

}  // namespace trocar::cli
