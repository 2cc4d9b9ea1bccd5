// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <CLI/App.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "command.h"
#include "program_folder.h"

namespace trocar::cli {
namespace {

/// Becomes the program trocar-window; comes back only when that fails.
core::Error StartWindow(const std::string& scene) {
  const std::filesystem::path program = FindProgramFolder() / "trocar-window";
  std::vector<std::string> words = {program.string()};
  if (!scene.empty()) words.push_back(scene);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  if (errno == ENOENT) {
    return {core::ErrorCode::kWindowMissing,
            "trocar-window is not beside this program: build it too (ninja programs, with "
            "TROCAR_BUILD_WINDOW=ON), or "
            "use trocar demo, which needs no window"};
  }
  return {core::ErrorCode::kWindowMissing,
          std::string("trocar-window does not start: ") + std::strerror(errno) + "; build it again"};
}

}  // namespace

void AddWindowCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand("window", "Open the simulator: two instruments, mouse and keyboard");
  auto scene = std::make_shared<std::string>();
  command->add_option("scene", *scene, "Scene file (JSON); the built-in patient if not given")
      ->type_name("FILE");
  command->footer("Example: trocar window scenes/demonstration.json");
  command->callback([scene, &outcome] { outcome.status = StartWindow(*scene); });
}

}  // namespace trocar::cli
