// SPDX-License-Identifier: Apache-2.0
/// \file state_file.h  A simulation's state in a file, and with it what the one who plays it remembers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/simulation/simulation.h"

namespace trocar::files {

/// Replaces the file as a whole or not at all.
/// \param player  bytes of a scripted surgeon or a recorder, or empty
/// \return kFileUnwritable
base::Status WriteStateFile(const std::filesystem::path& path, const simulation::Simulation& simulation,
                            std::span<const std::byte> player = {});

/// Restores the simulation.
/// \return the player's bytes; kFileMissing, kFileUnreadable, or kStateInvalid: then the simulation is as it was
base::Result<std::vector<std::byte>> ReadStateFile(const std::filesystem::path& path,
                                                   simulation::Simulation& simulation);

}  // namespace trocar::files
