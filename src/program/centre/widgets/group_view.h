// SPDX-License-Identifier: Apache-2.0
// Members and tasks of a group.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <string>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class GroupView : public Gtk::Box {
 public:
  GroupView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  Gtk::Box& MakeForm(const std::string& title, const std::string& about, const std::string& hint,
                     const std::string& button, std::function<void(const std::string&)> act);
  Gtk::Box& MakeNewGroup();
  Gtk::Box& MakeNewMember();
  Gtk::Box& MakeAssignment(const GroupPage& page);

  CentrePresenter* presenter_ = nullptr;
};

}  // namespace trocar::centre
