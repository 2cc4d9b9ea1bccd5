// SPDX-License-Identifier: Apache-2.0
/// \file opening_card.h  Card over the picture with what is prepared before an attempt can begin, and a button to give it up.
#pragma once

#include <gtkmm.h>

#include <string>

namespace trocar::app {

class OpeningCard : public Gtk::Box {
 public:
  OpeningCard();

  /// \param doing  what is prepared; empty: nothing, and the card is not shown
  /// \param share  of that, 0 to 1
  void Show(const std::string& doing, double share);
  sigc::signal<void()>& SignalCancelled() { return signal_cancelled_; }

 private:
  Gtk::Label doing_;
  Gtk::ProgressBar progress_;
  sigc::signal<void()> signal_cancelled_;
};

}  // namespace trocar::app
