// SPDX-License-Identifier: Apache-2.0
/// \file state_file.h  A simulation's state in a file, and with it what the one who plays it remembers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

/// Replaces the file as a whole or not at all.
/// \param player  bytes of a scripted surgeon or a recorder, or empty
/// \return kFileUnwritable
core::Status WriteStateFile(const std::filesystem::path& path, const Simulation& simulation,
                            std::span<const std::byte> player = {});

/// Restores the simulation.
/// \return the player's bytes; kFileMissing, kFileUnreadable, or kStateInvalid: then the simulation is as it was
core::Result<std::vector<std::byte>> ReadStateFile(const std::filesystem::path& path, Simulation& simulation);

}  // namespace trocar::simulation
