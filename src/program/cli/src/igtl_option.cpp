// SPDX-License-Identifier: Apache-2.0
#include "igtl_option.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

#include "trocar/host/log.h"

namespace trocar::cli {

void AddIgtlOption(CLI::App& command, int& port) {
  command
      .add_option(
          "--igtl", port,
          "Show tools and organs to 3D Slicer on this port of this machine (OpenIGTLink, RAS; 0: any port)")
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
}

base::Result<std::unique_ptr<net::IgtlServer>> ServeViewers(int port,
                                                            const simulation::Simulation& simulation) {
  net::IgtlServerSettings settings;
  settings.port = port;
  auto listening = net::IgtlServer::Make(settings, simulation.Surfaces());
  if (listening) {
    host::Log(host::LogLevel::kInfo,
              "OpenIGTLink: viewers may connect to localhost:" + std::to_string((*listening)->Port()));
  }
  return listening;
}

}  // namespace trocar::cli
