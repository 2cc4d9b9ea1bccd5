// SPDX-License-Identifier: Apache-2.0
/// \file window_settings.h  Settings of a person in the simulator's window, and what was trained last: kept in the user's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "trocar/base/result.h"

namespace trocar::presenter {

struct WindowSettings {
  bool is_left_handed = false;
  bool is_fulcrum_mirrored = false;  ///< as in a real trocar; false for beginners
  bool has_guides = true;
  bool has_panel = false;
  bool has_depth_snap = true;               ///< the wheel ends where the tip meets something, for beginners
  std::string person;                       ///< pseudonym of who operated last; empty: nobody in particular
  std::string patient;                      ///< folder of who is operated on; empty: the built-in one
  std::map<std::string, std::string> keys;  ///< of a command, by its id: name of the key that does it
  std::map<std::string, std::string> buttons;  ///< "close", "open", "look": "left", "middle" or "right"
  std::string last_task;                       ///< as Options::task; empty: none yet
  std::string last_part;                       ///< of an operation; empty: the whole
  std::string last_level = "normal";
  std::uint64_t last_seed = 1;
  int tutorial_step = 0;  ///< at which it goes on, 0 to kTutorialSteps; that one: it has been done

  friend bool operator==(const WindowSettings&, const WindowSettings&) = default;
};

struct LoadedWindowSettings {
  WindowSettings settings;               ///< the defaults where the file is missing or broken
  std::optional<base::Error> complaint;  ///< of a file that is there and cannot be used; it is kept
};
/// "window.json" of host::FindConfigFolder().
std::filesystem::path FindWindowSettings();
LoadedWindowSettings LoadWindowSettings(const std::filesystem::path& path);
/// \return the file's error
base::Status SaveWindowSettings(const std::filesystem::path& path, const WindowSettings& settings);

}  // namespace trocar::presenter
