// SPDX-License-Identifier: Apache-2.0
/// \file device_cards.h  The cards of the page of devices; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

#include "trocar/core/translate.h"
#include "trocar/gui/card.h"
#include "trocar/presenter/device_presenter.h"

namespace trocar::app {

/// What is plugged in, and which device is tried.
class FoundCard : public gui::Card {
 public:
  explicit FoundCard(presenter::DevicePresenter& presenter);
  void ShowFound(const std::vector<std::string>& devices);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::ListBox found_;
  Gtk::Entry spec_;
  Gtk::Button test_{core::Translate("Test")}, stop_{core::Translate("Stop")},
      find_{core::Translate("Look again")};
};

/// Which hand, and what is measured of it.
class CalibrationCard : public gui::Card {
 public:
  explicit CalibrationCard(presenter::DevicePresenter& presenter);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::DropDown hand_;
  Gtk::Button tip_{core::Translate("Tip")}, trocar_{core::Translate("Trocar")}, jaw_{core::Translate("Jaw")},
      swap_{core::Translate("Swap hands")};
  Gtk::ProgressBar progress_;
  Gtk::Label hint_, result_;
};

/// Which device holds the hands of the running operation, and its force.
class UseCard : public gui::Card {
 public:
  explicit UseCard(presenter::DevicePresenter& presenter);
  void Show(const presenter::DevicePageState& state);

 private:
  Gtk::Button use_{core::Translate("Hold the instruments")};
  Gtk::Entry haptic_name_;
  Gtk::Button use_haptics_{core::Translate("Use")}, check_pose_{core::Translate("Check pose")};
  Gtk::ToggleButton force_{core::Translate("Force")};
  Gtk::Label haptics_;
  bool is_showing_ = false;  // the toggle is being set by us
};

}  // namespace trocar::app
