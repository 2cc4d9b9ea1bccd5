// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "start_window.h"

namespace trocar::cli {

void AddAnatomyEditCommand(CLI::App& anatomy, Outcome& outcome) {
  struct Arguments {
    std::string patient, tool = "look";
  };
  CLI::App* command =
      anatomy.add_subcommand("edit", "Open a patient in a window: paint regions, move ducts and landmarks");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("patient", arguments->patient, "Patient folder")->required()->type_name("PATIENT");
  command->add_option("--tool", arguments->tool, "Tool to begin with")
      ->check(CLI::IsMember({"look", "paint", "tubes", "landmarks"}))
      ->capture_default_str();
  command->footer(
      "Needs a display. Changes are saved beside the folder every few seconds (PATIENT.autosave) until you "
      "save.\n"
      "Example: trocar anatomy generate --seed 7 -o out/seven && trocar anatomy edit out/seven");
  command->callback([arguments, &outcome] {
    outcome.status = StartWindow({"--edit-patient", arguments->patient, "--tool", arguments->tool});
  });
}

}  // namespace trocar::cli
