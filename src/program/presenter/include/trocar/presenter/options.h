// SPDX-License-Identifier: Apache-2.0
/// \file options.h  Command line of trocar-window: the simulator, the page of devices, or one of the editors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "trocar/base/result.h"
#include "trocar/editor/contour_options.h"
#include "trocar/editor/patient_editor_options.h"
#include "trocar/gui/run_options.h"

namespace trocar::presenter {

/// On whom is operated, and what of it.
struct OperationOptions {
  std::filesystem::path patient;  ///< folder in place of the scene's own; empty: none
  std::string part;               ///< key of an OperationPart; empty: the whole
};

/// Of the simulator and the page of devices.
struct Options {
  std::filesystem::path scene;   ///< empty: the built-in demonstration
  std::string task;              ///< training task by its name or file, in place of `scene`; empty: none
  std::string level = "normal";  ///< of that task
  std::uint64_t seed = 1;        ///< of that task
  OperationOptions operation;    ///< with a task that is one
  bool is_task_list = false;     ///< start with the list of tasks
  int threads = 0;               ///< of the solver; 0: chosen by the number of processors
  std::string device;   ///< hands of a device, as `trocar devices list` names it; empty: mouse and keyboard
  std::string haptics;  ///< haptic device; empty: none
  std::filesystem::path haptic_record;  ///< what force feedback did, written at the end; empty: none
  std::filesystem::path recordings;     ///< folder in which every attempt is kept; empty: none is
  std::filesystem::path replay;         ///< recording to play in place of a simulation; empty: none
  std::filesystem::path replay_beside;  ///< with `replay`: another one beside it; empty: none
  double replay_at = 0;                 ///< with `replay`: moment at which it begins [s]
  std::string store;  ///< where attempts go, as store::FindPlace reads it; empty: the person's own
  std::filesystem::path settings;  ///< file of the window's settings; empty: none are kept
  std::string trainee;             ///< who operates: name or pseudonym; empty: nobody in particular
  std::string
      page;  ///< open the training centre at "history", "courses", "group" or "exam"; empty: the simulator
  std::filesystem::path exam;  ///< with `page` "exam": sealed file to open; empty: none
  int igtl_port = -1;          ///< viewers over OpenIGTLink may connect here; 0: any port, -1: none
  bool is_fullscreen = false;
  int width = 1280, height = 800;  ///< of a window at first, where the screen is no smaller [pixels]
  int text_percent = 0;            ///< size of texts; 0: as the desktop has it
  bool is_high_contrast = false;   ///< also where the desktop's theme is one
  std::filesystem::path
      layout;  ///< every page is opened and looked at, and what was found is written here; empty: none
  bool is_demonstration = false;  ///< start with the script moving both hands
  gui::RunOptions run;            ///< its time is simulated

  // the device page
  bool is_device_page = false;  ///< open it alone; `device` is tried at once
  std::string calibrate;  ///< "tip", "trocar" or "jaw": measured as soon as the device answers; empty: none
};

/// Parsed command line.
struct CommandLine {
  Options options;
  editor::ContourOptions contours;              ///< with pictures: open the contour window
  editor::PatientEditorOptions patient_editor;  ///< with a patient: open the patient editor
  bool is_text_only = false;                    ///< print `text` and leave with success: --help, --version
  std::string text;
};

/// \return kUsage with what is wrong and how to get help
base::Result<CommandLine> ParseCommandLine(int argc, const char* const* argv);

/// Threads for the solver when the person names none: half of the processors, at least 1, at most 4; the
/// other half draws.
/// \param processors  as the system counts them, 0 where it cannot
int ChooseThreads(unsigned processors) noexcept;

}  // namespace trocar::presenter
