// SPDX-License-Identifier: Apache-2.0
/// \file command.h  The subcommands. Each lives in a file of its own and adds itself to the command line.
#pragma once

#include <string>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/base/result.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
}
namespace trocar::device {
struct DeviceStore;
}

namespace trocar::cli {

/// Result of the chosen subcommand.
struct Outcome {
  base::Status status;       ///< an error is printed by RunCommand
  bool has_finding = false;  ///< ran well, and what it found is not good (doctor): exit status 1
};

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
/// Words like "hydrops=0.5".
/// \return kUsage for one that is not like that
base::Result<std::vector<anatomy::ParameterSetting>> ParseSettings(const std::vector<std::string>& texts);
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
