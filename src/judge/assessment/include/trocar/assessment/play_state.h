// SPDX-License-Identifier: Apache-2.0
/// \file play_state.h  A play that was broken off, in a file: the simulation's state and what the surgeon remembers.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/agent/surgeon.h"
#include "trocar/base/result.h"
#include "trocar/simulation/simulation.h"

namespace trocar::assessment {

/// Where a play comes from and where it is left; empty paths: the first tick, and nowhere.
struct PlayFiles {
  std::filesystem::path restore, save;
  std::string who;  ///< name and seed of the surgeon
};

/// Both as they were when the file was written, by the surgeon of the same name and seed on the same scene and by the same engine
/// (simulation::kEngineBits). On an error either may be half restored.
/// \param who  name and seed of the surgeon
/// \return the file's error, or kStateInvalid
base::Status RestorePlay(const std::filesystem::path& path, const std::string& who,
                         simulation::Simulation& simulation, agent::Surgeon& surgeon);
base::Status SavePlay(const std::filesystem::path& path, const std::string& who,
                      const simulation::Simulation& simulation, agent::Surgeon& surgeon);

}  // namespace trocar::assessment
