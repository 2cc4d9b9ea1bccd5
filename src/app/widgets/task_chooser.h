// SPDX-License-Identifier: Apache-2.0
/// \file task_chooser.h  The list of training tasks and operations, over the picture.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

#include "trocar/app/task_request.h"
#include "trocar/gui/list_card.h"

namespace trocar::app {

class TaskChooser : public gui::ListCard {
 public:
  TaskChooser();

  /// Fills the list with what is delivered, once. \return the first file's error
  core::Status Load();
  sigc::signal<void(TaskRequest)>& SignalChosen() { return signal_chosen_; }

 private:
  void AddTask(const std::string& name, const std::string& about, const std::vector<std::string>& levels,
               TaskRequest request);

  Gtk::SpinButton seed_;
  bool is_loaded_ = false;
  sigc::signal<void(TaskRequest)> signal_chosen_;
};

}  // namespace trocar::app
