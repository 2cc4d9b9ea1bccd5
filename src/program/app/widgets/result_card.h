// SPDX-License-Identifier: Apache-2.0
/// \file result_card.h  How a task ended, over the picture: goals, errors, score, and what to do next.
#pragma once

#include <gtkmm.h>

#include "trocar/presenter/task_result.h"

namespace trocar::app {

class ResultCard : public Gtk::Box {
 public:
  ResultCard();

  /// Takes the place of what was shown before.
  void Show(const presenter::TaskResult& result);
  sigc::signal<void()>& SignalAgain() { return signal_again_; }
  sigc::signal<void()>& SignalOther() { return signal_other_; }
  sigc::signal<void()>& SignalSave() { return signal_save_; }
  sigc::signal<void()>& SignalClosed() { return signal_closed_; }

 private:
  void AddLine(const std::string& left, const std::string& middle, const std::string& right,
               const char* style);

  Gtk::Label title_, verdict_, score_;
  Gtk::Grid lines_;
  int line_count_ = 0;
  sigc::signal<void()> signal_again_, signal_other_, signal_save_, signal_closed_;
};

}  // namespace trocar::app
