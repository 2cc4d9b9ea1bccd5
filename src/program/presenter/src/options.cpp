// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/device/force_device_spec.h"
#include "trocar/editor/contour_script.h"
#include "trocar/host/version.h"
#include "trocar/presenter/window_settings.h"
#include "trocar/record/recording.h"

namespace trocar::presenter {
namespace {

base::Error Refusal(const std::string& what) {
  return {base::ErrorCode::kUsage, what + "; see trocar-window --help"};
}

void AddScene(CLI::App& app, Options& options) {
  app.add_option("--scene", options.scene,
                 "Scene to open, a JSON file (default: the built-in demonstration)");
  CLI::Option* task =
      app.add_option("--task", options.task,
                     "Training task to open: its name, as `trocar play --list` shows it, or a file")
          ->excludes("--scene");
  app.add_option("--level", options.level, "With --task: its difficulty")->needs(task)->capture_default_str();
  app.add_option("--part", options.operation.part,
                 "With --task cholecystectomy: this part of it, where the scripted expert has left it: "
                 "critical-view, clip-and-cut or bed")
      ->needs(task);
  app.add_option(
      "--patient", options.operation.patient,
      "Patient folder that operations are done on (default: who was chosen last, or the built-in one)");
  app.add_flag("--tasks", options.is_task_list, "Start with the list of training tasks to choose from")
      ->excludes(task);
  app.add_option("--seed", options.seed, "With --task: of its random parameters")
      ->needs(task)
      ->check(CLI::Range(0, 2147483647))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Threads of the solver; 0 chooses by the processors")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
}

void AddHands(CLI::App& app, Options& options) {
  app.add_option(
      "--device", options.device,
      "Hands of a tracker or other device in place of the mouse's, as `trocar devices list` names it");
  app.add_option("--haptics", options.haptics,
                 "Hands of a haptic device, with force: " + device::ListForceDrivers());
  app.add_option(
         "--haptic-record", options.haptic_record,
         "With --haptics: write rates, forces and every change of the force feedback to this file (JSON)")
      ->needs("--haptics");
  app.add_option("--igtl", options.igtl_port,
                 "Show tools and organs to 3D Slicer on this port of this machine (OpenIGTLink; 0: any port)")
      ->check(CLI::Range(0, 65535));
}

/// \param is_off  read by ChooseRecordings() afterwards
void AddRecordings(CLI::App& app, Options& options, bool& is_off) {
  CLI::Option* folder = app.add_option("--recordings", options.recordings,
                                       "Folder in which every attempt is kept, for trocar replay (default: "
                                       "~/.local/share/trocar/recordings; none with --screenshot)");
  app.add_flag("--no-recordings", is_off, "Keep no attempt")->excludes(folder);
}

void AddReplay(CLI::App& app, Options& options) {
  CLI::Option* replay =
      app.add_option("--replay", options.replay,
                     "Play this recording: any moment, any speed, any camera; take over anywhere")
          ->excludes("--scene")
          ->excludes("--task")
          ->excludes("--tasks")
          ->excludes("--demonstration")
          ->excludes("--screenshot");
  app.add_option("--beside", options.replay_beside, "With --replay: another recording beside it")
      ->needs(replay);
  app.add_option("--at", options.replay_at, "With --replay: begin at this second")
      ->needs(replay)
      ->check(CLI::Range(0.0, 1e6));
}

void AddCentre(CLI::App& app, Options& options) {
  app.add_option(
      "--store", options.store,
      "Where attempts are kept for history and courses: a SQLite file, or postgresql://... (default: "
      "TROCAR_STORE, else ~/.local/share/trocar/store/store.sqlite; none with --screenshot)");
  app.add_option(
      "--trainee", options.trainee,
      "Who operates: a name, which stays in a protected file on this computer, or a pseudonym (default: "
      "nobody in particular)");
  CLI::Option* page =
      app.add_option("--page", options.page, "Open the training centre at this page, without the simulator")
          ->check(CLI::IsMember({"history", "courses", "group", "exam"}))
          ->excludes("--scene")
          ->excludes("--task")
          ->excludes("--tasks")
          ->excludes("--demonstration")
          ->excludes("--replay");
  app.add_option("--exam", options.exam,
                 "With --page exam: sealed file to open, as trocar exam seal wrote it")
      ->needs(page);
}

/// A person's attempts are kept, those of an unattended run only where it asks for that.
void ChooseRecordings(bool is_off, Options& options) {
  if (!is_off && options.recordings.empty() && options.run.IsAttended())
    options.recordings = record::FindRecordingFolder();
}

void AddRun(CLI::App& app, Options& options) {
  app.add_option("--settings", options.settings,
                 "File that keeps the window's settings (default: window.json beside devices.json in "
                 "~/.config/trocar; none with --screenshot)");
  app.add_flag("--fullscreen", options.is_fullscreen, "Start in full screen (F11 switches)");
  app.add_option_function<std::string>(
         "--size",
         [&options](const std::string& text) {
           if (std::sscanf(text.c_str(), "%dx%d", &options.width, &options.height) != 2)
             throw CLI::ValidationError("--size", "two numbers of pixels, for example 1024x700");
         },
         "Size of a window at first, in pixels: 1280x800")
      ->type_name("WIDTHxHEIGHT");
  app.add_option("--text-percent", options.text_percent,
                 "Size of texts in per cent (default: as the desktop has it)")
      ->check(CLI::Range(50, 400));
  app.add_flag("--high-contrast", options.is_high_contrast,
               "White on black, with lines round what can be pressed (also where the desktop's theme has "
               "high contrast)");
  app.add_option("--check-layout", options.layout,
                 "Open every page, write what is cut off or off the screen in this JSON file, and quit");
  app.add_flag("--demonstration", options.is_demonstration,
               "Start with the demonstration: the script moves both hands");
  app.add_option("--screenshot", options.run.screenshot,
                 "Play the demonstration (with --edit-patient: show the patient), save the window's picture "
                 "in this PNG file, print what was measured as JSON, and quit");
  app.add_option("--after", options.run.screenshot_after, "With --screenshot: after this many seconds")
      ->check(CLI::Range(0.0, 3600.0))
      ->needs("--screenshot")
      ->capture_default_str();
}

void AddDevicePage(CLI::App& app, Options& options) {
  CLI::Option* devices =
      app.add_flag("--devices", options.is_device_page,
                   "Open the page that finds, tries and calibrates devices; --device is tried at once")
          ->excludes("--scene")
          ->excludes("--demonstration")
          ->excludes("--haptics");
  app.add_option("--calibrate", options.calibrate,
                 "With --devices: measure this as soon as the device answers")
      ->check(CLI::IsMember({"tip", "trocar", "jaw"}))
      ->needs(devices);
}

/// \param axes  read by SetAxes() afterwards
void AddSeries(CLI::App& app, images::ImageSeriesOptions& series, std::string& axes) {
  app.add_option("--pixel-mm", series.pixel_mm,
                 "With --contours: side of a pixel, where the files do not say it [mm]")
      ->check(CLI::Range(0.01, 20.0))
      ->needs("--contours");
  app.add_option("--slice-mm", series.slice_mm,
                 "With --contours: between two slices, where the files do not say it [mm]")
      ->check(CLI::Range(0.01, 50.0))
      ->needs("--contours");
  app.add_option("--series", series.series,
                 "With --contours: which DICOM series, where a folder holds several")
      ->check(CLI::Range(1, 999999999))
      ->needs("--contours");
  app.add_option("--pattern", series.pattern,
                 "With --contours: only pictures with such names, where a folder holds several stacks: "
                 "image-{slice:04}.jpeg")
      ->needs("--contours");
  app.add_option("--axes", axes,
                 "With --contours: where columns, rows and slices go to, where the files do not say it, for "
                 "example left,posterior,superior")
      ->needs("--contours");
}

void AddContours(CLI::App& app, editor::ContourOptions& options, std::string& axes) {
  CLI::Option* contours =
      app.add_option("--contours", options.images,
                     "Open the contour window on these pictures: a folder, a DICOM series or a "
                     "volume")
          ->excludes("--scene")
          ->excludes("--task")
          ->excludes("--demonstration")
          ->excludes("--threads");
  app.add_option("--points", options.points,
                 "With --contours: file of contours to go on with, or to begin (control points, JSON)")
      ->needs(contours);
  app.add_option("--reference", options.reference, "With --contours: label map to compare with (NIfTI, NRRD)")
      ->needs(contours);
  AddSeries(app, options.series, axes);
  app.add_option("--script", options.script, "With --contours: commands to begin with, one a line (below)")
      ->needs(contours);
  app.add_flag("--autosave", options.has_autosave,
               "With --screenshot: keep and recover unsaved work, as a window that a person attends does")
      ->needs(contours)
      ->needs("--screenshot");
  app.add_flag("--measure", options.is_measuring,
               "With --contours: drag points by itself, print the times as JSON, and quit")
      ->needs(contours);
}

void AddPatientEditor(CLI::App& app, std::filesystem::path& patient, std::string& tool) {
  CLI::Option* edit = app.add_option("--edit-patient", patient,
                                     "Open the patient editor on this folder: regions, ducts, landmarks")
                          ->excludes("--scene")
                          ->excludes("--demonstration")
                          ->excludes("--contours");
  app.add_option("--tool", tool, "With --edit-patient: tool to begin with")
      ->check(CLI::IsMember({"look", "paint", "tubes", "landmarks"}))
      ->needs(edit)
      ->capture_default_str();
}

/// \param text  three directions with commas; empty: nothing is said
base::Status SetAxes(const std::string& text, images::ImageSeriesOptions& series) {
  if (text.empty()) return {};
  std::array<std::string, 3> names;
  std::size_t count = 0;
  for (std::size_t at = 0; at <= text.size(); ++count) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    if (count < names.size()) names[count] = text.substr(at, end - at);
    at = end + 1;
  }
  if (count != names.size())
    return Refusal("--axes takes three directions, for example left,posterior,superior");
  series.axes = names;
  return {};
}

}  // namespace

base::Result<CommandLine> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine command;
  std::string axes, tool = "look";
  bool keeps_none = false;
  CLI::App app{"Trocar: the simulator window. Operate on a virtual abdomen with mouse and keyboard.",
               "trocar-window"};
  app.set_version_flag("--version", "trocar-window " + std::string(host::VersionText()));
  AddScene(app, command.options);
  AddHands(app, command.options);
  AddRecordings(app, command.options, keeps_none);
  AddRun(app, command.options);
  AddReplay(app, command.options);
  AddCentre(app, command.options);
  AddDevicePage(app, command.options);
  AddContours(app, command.contours, axes);
  AddPatientEditor(app, command.patient_editor.patient, tool);
  app.footer("Commands of --script:\n" + editor::DescribeContourScript() +
             "\nKeys are shown in the window: press H, in the contour window F1. Without a display, `trocar "
             "simulate` runs the same scene "
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
    return Refusal(error.what());
  }
  if (!std::isfinite(command.options.run.screenshot_after))
    return Refusal("--after must be a number of seconds");
  if (const base::Status set = SetAxes(axes, command.contours.series); !set) return set.error();
  command.patient_editor.tool = *editor::FindEditorTool(tool);
  ChooseRecordings(keeps_none, command.options);
  if (command.options.settings.empty() && command.options.run.IsAttended())
    command.options.settings = FindWindowSettings();
  command.contours.run = command.patient_editor.run = command.options.run;
  return command;
}

int ChooseThreads(unsigned processors) noexcept {
  return static_cast<int>(std::clamp(processors / 2, 1u, 4u));
}

}  // namespace trocar::presenter
