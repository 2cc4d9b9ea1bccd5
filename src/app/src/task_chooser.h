// SPDX-License-Identifier: Apache-2.0
/// \file task_chooser.h  The list of training tasks and operations, over the picture.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <string>
#include <vector>

#include "trocar/session/task.h"

namespace trocar::app {

/// What a person chose: a task with its level and seed, or a scene.
struct TaskWish {
  std::string task;             ///< key; empty: `scene` is meant
  std::filesystem::path scene;  ///< file
  session::TaskChoice choice;
};

class TaskChooser : public Gtk::Box {
 public:
  TaskChooser();

  /// Fills the list with what is delivered, once. \return the first file's error
  core::Status Load();
  sigc::signal<void(TaskWish)>& SignalChosen() { return signal_chosen_; }
  sigc::signal<void()>& SignalClosed() { return signal_closed_; }

 private:
  void AddTitle(const char* text);
  void AddRow(const std::string& name, const std::string& about, const std::vector<std::string>& levels,
              TaskWish wish);

  Gtk::Box rows_{Gtk::Orientation::VERTICAL};
  Gtk::SpinButton seed_;
  bool is_loaded_ = false;
  sigc::signal<void(TaskWish)> signal_chosen_;
  sigc::signal<void()> signal_closed_;
};

}  // namespace trocar::app
