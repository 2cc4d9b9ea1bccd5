// SPDX-License-Identifier: Apache-2.0
/// \file simulator_window.h  The window: picture, panel, keys and status line put together.
#pragma once

#include <gtkmm.h>

#include <memory>
#include <optional>
#include <thread>

#include "device_page.h"
#include "hand_events.h"
#include "help_card.h"
#include "panel.h"
#include "picture.h"
#include "result_card.h"
#include "task_chooser.h"
#include "trocar/app/hints.h"
#include "trocar/app/options.h"
#include "trocar/app/read_outs.h"
#include "trocar/app/session_control.h"
#include "trocar/app/task_result.h"
#include "trocar/core/clock.h"

namespace trocar::app {

class SimulatorWindow : public Gtk::ApplicationWindow {
 public:
  /// \param since_start  runs since the program began
  SimulatorWindow(const Options& options, const core::Stopwatch& since_start);
  ~SimulatorWindow() override;

  /// Writes what --haptic-record asks for; call it once the window has closed.
  void SaveHapticRecord();
  /// What went wrong, if anything did: the program's exit status follows it.
  const std::optional<core::Error>& GetFailure() const { return failure_; }

 private:
  void MakeHeader();
  void MakeContent();
  void StartLoading();
  void FinishLoading();
  bool UseDevices();
  bool OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock);
  void OnDrawn();
  void ShowHaptics();
  void OnAction(Action action);
  void Fail(const core::Error& error);
  void ShowSituation();
  void ShowEvents(const session::Snapshot& snapshot);
  void OpenDevices();
  void SetPaused(bool is_paused);
  void SetDemonstration(bool is_on);
  void Reset();
  void SaveScreenshotWhenDue(const session::Snapshot& snapshot);
  void SaveScreenshot();
  // tasks: simulator_window_tasks.cpp
  void MakeTaskCards();
  void OpenTaskList();
  void Open(const TaskWish& wish);
  void FollowTask(const session::TaskSnapshot& now);
  void SaveResult();

  Options options_;
  core::Stopwatch since_start_;
  double first_picture_ = 0;  // [s] since the start of the program

  Gtk::HeaderBar header_;
  Gtk::Button run_{"Start"}, reset_{"Reset"}, fullscreen_{"Full screen"}, quit_{"Quit"};
  Gtk::ToggleButton demonstration_{"Demonstration"}, forces_{"Forces"}, mask_{"Mask"},
      fulcrum_{"Real trocar"}, help_{"Help"};
  Gtk::ToggleButton force_{"Force"};
  Gtk::Button check_pose_{"Check pose"}, devices_{"Devices"}, tasks_{"Tasks"};
  Gtk::Overlay overlay_;
  Picture picture_;
  Panel panel_;
  HelpCard help_card_{KeyHelpRows()};
  TaskChooser chooser_;
  ResultCard result_card_;
  Gtk::Label badge_, hint_, event_, state_, haptics_;
  Gtk::Box failure_card_{Gtk::Orientation::VERTICAL};
  std::unique_ptr<HandEvents> hands_;
  bool is_showing_ = false;  // buttons are being set by us

  std::unique_ptr<SessionControl> control_;
  std::unique_ptr<DevicePage> device_page_;  // of control_
  StageMeter stages_;
  FrameMeter frames_;
  TaskErrorLog error_log_;
  TaskResult result_;             // of the task that is over
  bool is_result_known_ = false;  // it has been shown
  std::uint64_t seen_events_ = 0;
  double last_frame_ = 0, last_forces_ = 0, last_times_ = 0;  // of the frame clock [s]
  bool is_screenshot_due_ = false;
  std::optional<core::Error> failure_;

  // the scene is read while the window appears
  std::thread loader_;
  Glib::Dispatcher loaded_;
  std::optional<core::Result<session::Simulation>> simulation_;  // written by loader_ before it emits loaded_
};

}  // namespace trocar::app
