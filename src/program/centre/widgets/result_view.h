// SPDX-License-Identifier: Apache-2.0
// The page of one attempt.
#pragma once

#include <gtkmm.h>

#include "trocar/centre/centre_presenter.h"
#include "trocar/gui/columns.h"
#include "trocar/gui/file_dialog.h"

namespace trocar::centre {

class ResultView : public Gtk::Box {
 public:
  ResultView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  /// Takes the place of what was shown before.
  void Show(const CentrePage& page);

 private:
  void ShowHead(const ResultPage& page, Gtk::Box& into);
  void ShowAdvice(const ResultPage& page, Gtk::Box& into);
  void ShowErrors(const ResultPage& page, Gtk::Box& into);
  void ShowNumbers(const ResultPage& page, Gtk::Box& into);
  gui::Columns& MakeActions(const ResultPage& page);
  void ChooseReport();

  CentrePresenter* presenter_ = nullptr;
  gui::FileDialog file_dialog_;
  std::string file_name_;  // that is suggested for the report
};

}  // namespace trocar::centre
