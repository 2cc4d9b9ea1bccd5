// SPDX-License-Identifier: Apache-2.0
/// \file options.h  Command line of trocar-window: the simulator, or with --contours the contour window.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "trocar/core/result.h"
#include "trocar/images/image_series.h"

namespace trocar::app {

struct Options {
  std::filesystem::path scene;   ///< empty: the built-in demonstration
  std::string task;              ///< training task by its name or file, in place of `scene`; empty: none
  std::string level = "normal";  ///< of that task
  std::uint64_t seed = 1;        ///< of that task
  bool is_task_list = false;     ///< start with the list of tasks
  int threads = 0;               ///< of the solver; 0: chosen by the number of processors
  std::string device;   ///< hands of a device, as `trocar devices list` names it; empty: mouse and keyboard
  std::string haptics;  ///< haptic device; empty: none
  std::filesystem::path haptic_record;  ///< what force feedback did, written at the end; empty: none
  int igtl_port = -1;                   ///< viewers over OpenIGTLink may connect here; 0: any port, -1: none
  bool is_fullscreen = false;
  bool is_demonstration = false;     ///< start with the script moving both hands
  std::filesystem::path screenshot;  ///< empty: none. Otherwise play, save the window's picture and quit
  double screenshot_after = 5;       ///< after this many seconds of simulation [s]

  // the device page
  bool is_device_page = false;  ///< open it alone; `device` is tried at once
  std::string calibrate;  ///< "tip", "trocar" or "jaw": measured as soon as the device answers; empty: none

  // the contour window
  std::filesystem::path images;       ///< not empty: open the contour window on these pictures
  std::filesystem::path points;       ///< file of contours, which need not exist yet; empty: none
  std::filesystem::path reference;    ///< label map to compare with; empty: none
  images::ImageSeriesOptions series;  ///< what the pictures do not say
  std::filesystem::path script;       ///< commands to begin with; empty: none
  bool has_autosave = false;          ///< also in a run that nobody watches
  bool is_measuring = false;          ///< drag a point for some seconds, print the times and quit
  // the patient editor
  std::filesystem::path patient;     ///< not empty: open the patient editor on this folder
  std::string editor_tool = "look";  ///< "look", "paint", "tubes" or "landmarks"
};

/// What the command line asks for.
struct CommandLine {
  Options options;
  bool is_text_only = false;  ///< print `text` and leave with success: --help, --version
  std::string text;
};

/// \return kUsage with what is wrong and how to get help
core::Result<CommandLine> ParseCommandLine(int argc, const char* const* argv);

/// Threads for the solver when the person names none: half of the processors, at least 1, at most 4; the
/// other half draws.
/// \param processors  as the system counts them, 0 where it cannot
int ChooseThreads(unsigned processors) noexcept;

}  // namespace trocar::app
