// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "start_window.h"
#include "trocar/device/force_device_spec.h"

namespace trocar::cli {

void AddWindowCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand("window", "Open the simulator: two instruments, mouse and keyboard");
  auto scene = std::make_shared<std::string>();
  command->add_option("scene", *scene, "Scene file (JSON); the built-in patient if not given")
      ->type_name("FILE");
  auto device = std::make_shared<std::string>();
  command
      ->add_option("--device", *device,
                   "Hands of a tracker or other device (trocar devices list) in place of the mouse's, where "
                   "it sees them")
      ->type_name("DEVICE");
  auto haptics = std::make_shared<std::string>();
  command
      ->add_option("--haptics", *haptics,
                   "Hands of a haptic device, with force: " + device::ListForceDrivers())
      ->type_name("DEVICE");
  command->footer(
      "Examples: trocar window scenes/demonstration.json\n"
      "          trocar window --device liberty:/dev/ttyUSB0+jaw:/dev/ttyACM0");
  command->callback([scene, device, haptics, &outcome] {
    std::vector<std::string> arguments;
    if (!scene->empty()) arguments = {"--scene", *scene};
    if (!device->empty()) arguments.insert(arguments.end(), {"--device", *device});
    if (!haptics->empty()) arguments.insert(arguments.end(), {"--haptics", *haptics});
    outcome.status = StartWindow(arguments);
  });
}

}  // namespace trocar::cli
