// SPDX-License-Identifier: Apache-2.0
/// \file task_chooser.h  The list of training tasks and operations, over the picture.
#pragma once

#include <gtkmm.h>

#include "trocar/gui/list_card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/task_page.h"

namespace trocar::app {

class TaskChooser : public gui::ListCard {
 public:
  TaskChooser();

  void Show(const presenter::TaskPage& page);
  sigc::signal<void(presenter::TaskRequest)>& SignalChosen() { return signal_chosen_; }
  sigc::signal<void()>& SignalPatients() { return signal_patients_; }

 private:
  void AddTask(const presenter::TaskPage::Row& row);

  Gtk::SpinButton seed_;
  Gtk::Button patients_{host::Translate("Another patient…")};
  sigc::signal<void(presenter::TaskRequest)> signal_chosen_;
  sigc::signal<void()> signal_patients_;
};

}  // namespace trocar::app
