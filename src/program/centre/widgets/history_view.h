// SPDX-License-Identifier: Apache-2.0
// The page of attempts and learning.
#pragma once

#include <gtkmm.h>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class HistoryView : public Gtk::Box {
 public:
  HistoryView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  Gtk::Box& MakeHead(const HistoryPage& page);
  Gtk::Widget& MakeList(const HistoryPage& page);
  Gtk::Box& MakeLearning(const HistoryPage& page);

  CentrePresenter* presenter_ = nullptr;
};

}  // namespace trocar::centre
