// SPDX-License-Identifier: Apache-2.0
// Members and tasks of a group.
#pragma once

#include <gtkmm.h>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class GroupView : public Gtk::Box {
 public:
  GroupView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  CentrePresenter* presenter_ = nullptr;
};

}  // namespace trocar::centre
