// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "trocar/core/version.h"

namespace trocar::app {

core::Result<Command> ParseCommandLine(int argc, const char* const* argv) {
  Command command;
  Options& options = command.options;
  CLI::App app{"Trocar: the simulator window. Operate on a virtual abdomen with mouse and keyboard.",
               "trocar-window"};
  app.set_version_flag("--version", "trocar-window " + std::string(core::VersionText()));
  app.add_option("--scene", options.scene,
                 "Scene to open, a JSON file (default: the built-in demonstration)");
  app.add_option("--threads", options.threads, "Threads of the solver; 0 chooses by the processors")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_flag("--fullscreen", options.is_fullscreen, "Start in full screen (F11 switches)");
  app.add_flag("--demonstration", options.is_demonstration,
               "Start with the demonstration: the script moves both hands");
  CLI::Option* screenshot = app.add_option(
      "--screenshot", options.screenshot,
      "Play the demonstration (with --edit-patient: show the patient), save the window's picture "
      "in this PNG file, print what was measured as JSON, and quit");
  app.add_option("--after", options.screenshot_after, "With --screenshot: after this many seconds")
      ->check(CLI::Range(0.0, 3600.0))
      ->needs(screenshot)
      ->capture_default_str();
  CLI::Option* patient = app.add_option("--edit-patient", options.patient,
                                        "Open the patient editor on this folder: regions, ducts, landmarks")
                             ->excludes("--scene")
                             ->excludes("--demonstration");
  app.add_option("--tool", options.editor_tool, "With --edit-patient: tool to begin with")
      ->check(CLI::IsMember({"look", "paint", "tubes", "landmarks"}))
      ->needs(patient)
      ->capture_default_str();
  app.footer(
      "Keys are shown in the window: press H. Without a display, `trocar simulate` runs the same scene "
      "headless.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    command.is_text_only = true;
    command.text = app.help();
  } catch (const CLI::CallForVersion&) {
    command.is_text_only = true;
    command.text = app.version() + "\n";
  } catch (const CLI::Error& error) {
    return core::Error{core::ErrorCode::kUsage, std::string(error.what()) + "; see trocar-window --help"};
  }
  if (!std::isfinite(options.screenshot_after)) {
    return core::Error{core::ErrorCode::kUsage,
                       "--after must be a number of seconds; see trocar-window --help"};
  }
  return command;
}

int ChooseThreads(unsigned processors) noexcept {
  return static_cast<int>(std::clamp(processors / 2, 1u, 4u));
}

}  // namespace trocar::app
