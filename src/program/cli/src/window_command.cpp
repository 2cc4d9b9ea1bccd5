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

namespace {

struct WindowOptions {
  std::string scene, task, level, part, patient, device, haptics, record, recordings, replay, beside, store,
      trainee, page, exam;
  bool has_list = false, keeps_none = false;
  int igtl_port = -1;
};

/// As the window's own program takes them.
std::vector<std::string> FormatArguments(const WindowOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {name, value});
  };
  add("--scene", options.scene);
  add("--task", options.task);
  add("--level", options.level);
  add("--part", options.part);
  add("--patient", options.patient);
  if (options.has_list) arguments.emplace_back("--tasks");
  add("--device", options.device);
  add("--haptics", options.haptics);
  add("--haptic-record", options.record);
  add("--recordings", options.recordings);
  if (options.keeps_none) arguments.emplace_back("--no-recordings");
  add("--replay", options.replay);
  add("--beside", options.beside);
  add("--store", options.store);
  add("--trainee", options.trainee);
  add("--page", options.page);
  add("--exam", options.exam);
  if (options.igtl_port >= 0) add("--igtl", std::to_string(options.igtl_port));
  return arguments;
}

}  // namespace

void AddWindowCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "window");
  auto options = std::make_shared<WindowOptions>();
  command->add_option("scene", options->scene, "Scene file (JSON); the built-in patient if not given")
      ->type_name("FILE");
  CLI::Option* one = command
                         ->add_option("--task", options->task,
                                      "Training task to open: its name (trocar play --list), or a file")
                         ->excludes("scene")
                         ->type_name("TASK");
  command->add_option("--level", options->level, "With --task: its difficulty")
      ->needs(one)
      ->type_name("LEVEL");
  command
      ->add_option("--part", options->part,
                   "With --task cholecystectomy: this part of it, where the scripted expert has left it: "
                   "critical-view, clip-and-cut or bed")
      ->needs(one)
      ->type_name("PART");
  command
      ->add_option(
          "--patient", options->patient,
          "Patient folder that operations are done on (default: who was chosen last, or the built-in "
          "one)")
      ->type_name("DIR");
  command->add_flag("--tasks", options->has_list, "Start with the list of training tasks to choose from")
      ->excludes(one);
  command
      ->add_option("--device", options->device,
                   "Hands of a tracker or other device (trocar devices list) in place of the mouse's, where "
                   "it sees them")
      ->type_name("DEVICE");
  command
      ->add_option("--haptics", options->haptics,
                   "Hands of a haptic device, with force: " + device::ListForceDrivers())
      ->type_name("DEVICE");
  command
      ->add_option("--haptic-record", options->record,
                   "With --haptics: write rates, forces and every change of the force feedback here (JSON)")
      ->needs("--haptics")
      ->type_name("FILE");
  CLI::Option* folder = command
                            ->add_option("--recordings", options->recordings,
                                         "Folder in which every attempt is kept, for trocar replay (default: "
                                         "~/.local/share/trocar/recordings)")
                            ->type_name("DIR");
  command->add_flag("--no-recordings", options->keeps_none, "Keep no attempt")->excludes(folder);
  CLI::Option* played =
      command
          ->add_option("--replay", options->replay,
                       "Play this recording: any moment, any speed, any camera; take over anywhere")
          ->excludes("scene")
          ->excludes(one)
          ->excludes("--tasks")
          ->type_name("FILE");
  command->add_option("--beside", options->beside, "With --replay: another recording beside it")
      ->needs(played)
      ->type_name("FILE");
  command
      ->add_option(
          "--store", options->store,
          "Where attempts are kept for history and courses: a SQLite file, or postgresql://... (default: "
          "TROCAR_STORE, else ~/.local/share/trocar/store/store.sqlite)")
      ->type_name("URL");
  command
      ->add_option("--trainee", options->trainee,
                   "Who operates: a name, which stays in a protected file on this computer, or a pseudonym")
      ->type_name("NAME");
  CLI::Option* centre = command
                            ->add_option("--page", options->page,
                                         "Open the training centre at this page, without the simulator")
                            ->check(CLI::IsMember({"history", "courses", "group", "exam"}))
                            ->excludes("scene")
                            ->excludes(one);
  command
      ->add_option("--exam", options->exam,
                   "With --page exam: sealed file to open, as trocar exam seal wrote it")
      ->needs(centre)
      ->type_name("FILE");
  AddIgtlOption(*command, options->igtl_port);
  command->footer(
      "Examples: trocar window scenes/demonstration.json\n"
      "          trocar window --task wire_run --level easy\n"
      "          trocar window --task cholecystectomy --part bed --patient my_patient\n"
      "          trocar window --replay attempt.trocar --beside expert.trocar\n"
      "          trocar window --page courses --trainee \"Anna Berg\"\n"
      "          trocar window --device liberty:/dev/ttyUSB0+jaw:/dev/ttyACM0");
  command->callback([options, &outcome] { outcome.status = StartWindow(FormatArguments(*options)); });
}

}  // namespace trocar::cli
