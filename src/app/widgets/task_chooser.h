// SPDX-License-Identifier: Apache-2.0
/// \file task_chooser.h  The list of training tasks and operations, over the picture.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

#include "trocar/app/task_request.h"

namespace trocar::app {

class TaskChooser : public Gtk::Box {
 public:
  TaskChooser();

  /// Fills the list with what is delivered, once. \return the first file's error
  core::Status Load();
  sigc::signal<void(TaskRequest)>& SignalChosen() { return signal_chosen_; }
  sigc::signal<void()>& SignalClosed() { return signal_closed_; }

 private:
  void AddTitle(const char* text);
  void AddRow(const std::string& name, const std::string& about, const std::vector<std::string>& levels,
              TaskRequest request);

  Gtk::Box rows_{Gtk::Orientation::VERTICAL};
  Gtk::SpinButton seed_;
  bool is_loaded_ = false;
  sigc::signal<void(TaskRequest)> signal_chosen_;
  sigc::signal<void()> signal_closed_;
};

}  // namespace trocar::app
