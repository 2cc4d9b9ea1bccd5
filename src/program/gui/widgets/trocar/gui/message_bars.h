// SPDX-License-Identifier: Apache-2.0
/// \file message_bars.h  Messages over the whole width that stay until somebody has read them.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/gui/question.h"

namespace trocar::gui {

class MessageBars : public Gtk::ScrolledWindow {
 public:
  MessageBars();

  /// Code, and message with the remedy. The same error again is counted, not repeated.
  void ShowError(const base::Error& error);
  void ShowNotice(const std::string& text);
  /// Goes with the first answer. A question with the same text takes the place of the old one.
  void Ask(Question question);
  /// Gives the answer of that label to the first question that has it, as a click would.
  /// \return false where none has it
  bool Press(const std::string& label);
  /// Texts of what is shown, from the top.
  std::vector<std::string> Texts() const;

 private:
  Gtk::Box& AddBar(const std::string& style, const std::string& code, const std::string& text);
  void Remove(Gtk::Widget& bar);

  struct Shown {
    Gtk::Box* bar;
    std::string text;
    Gtk::Label* count;
    int times;
    std::vector<Answer> answers;
  };
  Gtk::Box bars_{Gtk::Orientation::VERTICAL};
  std::vector<Shown> shown_;
};

}  // namespace trocar::gui
