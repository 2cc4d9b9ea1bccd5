// SPDX-License-Identifier: Apache-2.0
// An exam: opened, sat, certified.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <string>

#include "trocar/centre/centre_presenter.h"
#include "trocar/gui/file_dialog.h"

namespace trocar::centre {

class ExamView : public Gtk::Box {
 public:
  ExamView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  Gtk::Box& MakeInvitation();
  Gtk::Box& MakeSealing(const ExamPage& page);
  Gtk::Box& MakeKeys();
  Gtk::Box& MakeFacts(const ExamPage& page);
  Gtk::Box& MakeSitting(const ExamPage& page);
  Gtk::Box& MakeCertificate(const ExamPage& page);
  void ChooseExam();
  void ChooseSealed(const std::string& name, const std::string& task, const std::string& level);
  void ChooseNewKeys(const std::string& passphrase);
  void ChooseKey(const std::string& certificate_name);
  void ChooseCertificate(const std::filesystem::path& key, const std::string& name);

  CentrePresenter* presenter_ = nullptr;
  gui::FileDialog file_dialog_;
  Gtk::PasswordEntry passphrase_;  // of the key; keeps what is typed when the page is shown anew
};

}  // namespace trocar::centre
