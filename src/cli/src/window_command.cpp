// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "igtl_option.h"
#include "start_window.h"
#include "trocar/device/force_device_spec.h"

namespace trocar::cli {

void AddWindowCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand("window", "Open the simulator: two instruments, mouse and keyboard");
  auto scene = std::make_shared<std::string>();
  command->add_option("scene", *scene, "Scene file (JSON); the built-in patient if not given")
      ->type_name("FILE");
  auto task = std::make_shared<std::string>();
  CLI::Option* one =
      command->add_option("--task", *task, "Training task to open: its name (trocar play --list), or a file")
          ->excludes("scene")
          ->type_name("TASK");
  auto level = std::make_shared<std::string>();
  command->add_option("--level", *level, "With --task: its difficulty")->needs(one)->type_name("LEVEL");
  auto has_list = std::make_shared<bool>(false);
  command->add_flag("--tasks", *has_list, "Start with the list of training tasks to choose from")
      ->excludes(one);
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
  auto record = std::make_shared<std::string>();
  command
      ->add_option("--haptic-record", *record,
                   "With --haptics: write rates, forces and every change of the force feedback here (JSON)")
      ->needs("--haptics")
      ->type_name("FILE");
  auto recordings = std::make_shared<std::string>();
  auto keeps_none = std::make_shared<bool>(false);
  CLI::Option* folder = command
                            ->add_option("--recordings", *recordings,
                                         "Folder in which every attempt is kept, for trocar replay (default: "
                                         "~/.local/share/trocar/recordings)")
                            ->type_name("DIR");
  command->add_flag("--no-recordings", *keeps_none, "Keep no attempt")->excludes(folder);
  auto replay = std::make_shared<std::string>(), beside = std::make_shared<std::string>();
  CLI::Option* played =
      command
          ->add_option("--replay", *replay,
                       "Play this recording: any moment, any speed, any camera; take over anywhere")
          ->excludes("scene")
          ->excludes(one)
          ->excludes("--tasks")
          ->type_name("FILE");
  command->add_option("--beside", *beside, "With --replay: another recording beside it")
      ->needs(played)
      ->type_name("FILE");
  auto store = std::make_shared<std::string>(), trainee = std::make_shared<std::string>(),
       page = std::make_shared<std::string>(), exam = std::make_shared<std::string>();
  command
      ->add_option(
          "--store", *store,
          "Where attempts are kept for history and courses: a SQLite file, or postgresql://... (default: "
          "TROCAR_STORE, else ~/.local/share/trocar/store/store.sqlite)")
      ->type_name("URL");
  command
      ->add_option("--trainee", *trainee,
                   "Who operates: a name, which stays in a protected file on this computer, or a pseudonym")
      ->type_name("NAME");
  CLI::Option* centre =
      command->add_option("--page", *page, "Open the training centre at this page, without the simulator")
          ->check(CLI::IsMember({"history", "courses", "group", "exam"}))
          ->excludes("scene")
          ->excludes(one);
  command->add_option("--exam", *exam, "With --page exam: sealed file to open, as trocar exam seal wrote it")
      ->needs(centre)
      ->type_name("FILE");
  auto igtl_port = std::make_shared<int>(-1);
  AddIgtlOption(*command, *igtl_port);
  command->footer(
      "Examples: trocar window scenes/demonstration.json\n"
      "          trocar window --task wire_run --level easy\n"
      "          trocar window --replay attempt.trocar --beside expert.trocar\n"
      "          trocar window --page courses --trainee \"Anna Berg\"\n"
      "          trocar window --device liberty:/dev/ttyUSB0+jaw:/dev/ttyACM0");
  command->callback([scene, task, level, has_list, device, haptics, record, recordings, keeps_none, replay,
                     beside, store, trainee, page, exam, igtl_port, &outcome] {
    std::vector<std::string> arguments;
    if (!scene->empty()) arguments = {"--scene", *scene};
    if (!task->empty()) arguments.insert(arguments.end(), {"--task", *task});
    if (!level->empty()) arguments.insert(arguments.end(), {"--level", *level});
    if (*has_list) arguments.emplace_back("--tasks");
    if (!device->empty()) arguments.insert(arguments.end(), {"--device", *device});
    if (!haptics->empty()) arguments.insert(arguments.end(), {"--haptics", *haptics});
    if (!record->empty()) arguments.insert(arguments.end(), {"--haptic-record", *record});
    if (!recordings->empty()) arguments.insert(arguments.end(), {"--recordings", *recordings});
    if (*keeps_none) arguments.emplace_back("--no-recordings");
    if (!replay->empty()) arguments.insert(arguments.end(), {"--replay", *replay});
    if (!beside->empty()) arguments.insert(arguments.end(), {"--beside", *beside});
    if (!store->empty()) arguments.insert(arguments.end(), {"--store", *store});
    if (!trainee->empty()) arguments.insert(arguments.end(), {"--trainee", *trainee});
    if (!page->empty()) arguments.insert(arguments.end(), {"--page", *page});
    if (!exam->empty()) arguments.insert(arguments.end(), {"--exam", *exam});
    if (*igtl_port >= 0) arguments.insert(arguments.end(), {"--igtl", std::to_string(*igtl_port)});
    outcome.status = StartWindow(arguments);
  });
}

}  // namespace trocar::cli
