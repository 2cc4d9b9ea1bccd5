// SPDX-License-Identifier: Apache-2.0
/// \file patient_list_card.h  Patients with their pictures, over the picture: who is operated on, and new ones.
#pragma once

#include <gtkmm.h>

#include <filesystem>

#include "trocar/gui/file_dialog.h"
#include "trocar/gui/list_card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/patient_desk.h"

namespace trocar::app {

class PatientListCard : public gui::ListCard {
 public:
  PatientListCard();
  ~PatientListCard() override;

  /// Reads the list anew.
  void Load(const std::filesystem::path& chosen);
  /// The folder; empty: the built-in one.
  sigc::signal<void(std::filesystem::path)>& SignalChosen() { return signal_chosen_; }
  /// A patient is to be made from images.
  sigc::signal<void()>& SignalImages() { return signal_images_; }

 private:
  void MakeFoot();
  void Show();
  void ShowProgress();
  void AddPatient(const presenter::PatientEntry& patient);
  void AskForLabels();
  void Begin();
  void OnNews();

  Gtk::Label problem_, doing_;
  Gtk::ProgressBar progress_;
  Gtk::Button cancel_{host::Translate("Cancel")}, generate_{host::Translate("Make it")},
      import_{host::Translate("From a label map…")}, images_{host::Translate("From images…")};
  Gtk::SpinButton seed_;
  Gtk::Box under_way_;
  gui::FileDialog file_dialog_;
  sigc::connection pulse_;
  Glib::Dispatcher news_;
  sigc::signal<void(std::filesystem::path)> signal_chosen_;
  sigc::signal<void()> signal_images_;
  presenter::PatientDesk desk_;  // ends before what it uses
};

}  // namespace trocar::app
