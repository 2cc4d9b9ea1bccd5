// SPDX-License-Identifier: Apache-2.0
/// \file play_state.h  A play that was broken off, in a file: the simulation's state and what the surgeon remembers.
#pragma once

#include <filesystem>

#include "trocar/agent/surgeon.h"
#include "trocar/core/result.h"
#include "trocar/simulation/simulation.h"

namespace trocar::cli {

/// Where a play comes from and where it is left; empty paths: the first tick, and nowhere.
struct PlayFiles {
  std::filesystem::path restore, save;
};

/// Both as they were when the file was written, by the same kind of surgeon on the same scene.
/// \return the file's error, or kStateInvalid
core::Status RestorePlay(const std::filesystem::path& path, simulation::Simulation& simulation,
                         agent::Surgeon& surgeon);
core::Status SavePlay(const std::filesystem::path& path, const simulation::Simulation& simulation,
                      agent::Surgeon& surgeon);

}  // namespace trocar::cli
