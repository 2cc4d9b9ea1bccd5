// SPDX-License-Identifier: Apache-2.0
/// \file home_card.h  The widgets of the home page.
#pragma once

#include <gtkmm.h>

#include <map>

#include "trocar/presenter/home.h"

namespace trocar::app {

class HomeCard : public Gtk::Box {
 public:
  HomeCard();

  void Show(const presenter::HomePage& page);
  /// Gives the keyboard to the first thing that can be chosen, not to the name.
  void FocusFirst();
  sigc::signal<void(presenter::HomeChoice)>& SignalChosen() { return signal_chosen_; }
  /// Name or pseudonym that was typed.
  sigc::signal<void(std::string)>& SignalPerson() { return signal_person_; }

 private:
  struct Row {
    Gtk::Button* button;
    Gtk::Label *title, *about;
    Gtk::Picture* picture;
  };
  void ShowLead(presenter::HomeChoice choice, const std::optional<presenter::HomeLead>& lead);

  Gtk::Label who_, patient_, problem_;
  Gtk::Entry name_;
  std::map<presenter::HomeChoice, Row> rows_;
  sigc::signal<void(presenter::HomeChoice)> signal_chosen_;
  sigc::signal<void(std::string)> signal_person_;
};

}  // namespace trocar::app
