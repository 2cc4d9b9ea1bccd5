// SPDX-License-Identifier: Apache-2.0
// An exam: opened, sat, certified.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <string>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class ExamView : public Gtk::Box {
 public:
  ExamView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  void ChooseFile(const char* title, Gtk::FileChooser::Action action, const std::string& name,
                  std::function<void(std::string)> chosen);
  void ChooseKey(const ExamPage& page);

  CentrePresenter* presenter_ = nullptr;
};

}  // namespace trocar::centre
