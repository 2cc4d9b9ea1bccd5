// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "start_window.h"

namespace trocar::cli {

void AddWindowCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand("window", "Open the simulator: two instruments, mouse and keyboard");
  auto scene = std::make_shared<std::string>();
  command->add_option("scene", *scene, "Scene file (JSON); the built-in patient if not given")
      ->type_name("FILE");
  command->footer("Example: trocar window scenes/demonstration.json");
  command->callback([scene, &outcome] {
    std::vector<std::string> arguments;
    if (!scene->empty()) arguments = {"--scene", *scene};
    outcome.status = StartWindow(arguments);
  });
}

}  // namespace trocar::cli
