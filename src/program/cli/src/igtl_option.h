// SPDX-License-Identifier: Apache-2.0
/// \file igtl_option.h  --igtl: viewers look on at a simulation over OpenIGTLink.
#pragma once

#include <CLI/App.hpp>
#include <memory>

#include "trocar/net/igtl_server.h"
#include "trocar/simulation/simulation.h"

namespace trocar::cli {

/// \param[in,out] port  -1: nobody looks on; lives as long as the command
void AddIgtlOption(CLI::App& command, int& port);

/// Listens, and says where.
/// \param port  0 lets the system choose
/// \return kDeviceBusy
base::Result<std::unique_ptr<net::IgtlServer>> ServeViewers(int port,
                                                            const simulation::Simulation& simulation);

}  // namespace trocar::cli
