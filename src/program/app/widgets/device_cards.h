// SPDX-License-Identifier: Apache-2.0
/// \file device_cards.h  The cards of the page of devices; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

#include "trocar/gui/card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/device_presenter.h"

namespace trocar::app {

/// Card of the devices that are plugged in, and of the one that is tried.
class FoundCard : public gui::Card {
 public:
  explicit FoundCard(presenter::DevicePresenter& presenter);
  void ShowFound(const std::vector<std::string>& devices);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::ListBox found_;
  Gtk::Entry spec_;
  Gtk::Button test_{host::Translate("Test")}, stop_{host::Translate("Stop")},
      find_{host::Translate("Look again")};
};

/// Which hand, and what is measured of it.
class CalibrationCard : public gui::Card {
 public:
  explicit CalibrationCard(presenter::DevicePresenter& presenter);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::DropDown hand_;
  Gtk::Button tip_{host::Translate("Tip")}, trocar_{host::Translate("Trocar")}, jaw_{host::Translate("Jaw")},
      swap_{host::Translate("Swap hands")};
  Gtk::ProgressBar progress_;
  Gtk::Label hint_, result_;
};

/// Which device holds the hands of the running operation, and its force.
class UseCard : public gui::Card {
 public:
  explicit UseCard(presenter::DevicePresenter& presenter);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::Button use_{host::Translate("Hold the instruments")};
  Gtk::Entry haptic_name_;
  Gtk::Button use_haptics_{host::Translate("Use")}, check_pose_{host::Translate("Check pose")};
  Gtk::ToggleButton force_{host::Translate("Force")};
  Gtk::Label haptics_;
  bool is_showing_ = false;  // the toggle is being set by us
};

}  // namespace trocar::app
