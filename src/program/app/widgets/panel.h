// SPDX-License-Identifier: Apache-2.0
/// \file panel.h  The right side of the simulator's window: read-outs and settings in cards.
#pragma once

#include <gtkmm.h>

#include "panel_cards.h"
#include "trocar/presenter/panel_presenter.h"

namespace trocar::app {

class Panel : public Gtk::ScrolledWindow, private presenter::PanelScreen {
 public:
  Panel();

  presenter::PanelPresenter& Presenter() { return presenter_; }
  /// Adds a card below the others.
  void Add(gui::Card& card) { cards_.append(card); }

 private:
  // PanelScreen
  void ShowScene(const presenter::ScenePage& page) override;
  void ShowHands(const presenter::HandPages& page) override { hands_.Show(page); }
  void ShowOperation(const presenter::OperationPage& page) override;
  void ShowTask(const presenter::TaskReadOut& page) override { task_.Show(page); }
  void ShowSettings(const presenter::SettingsPage& page) override { settings_.Show(page); }
  void ShowSetting(std::size_t row, const std::string& value) override { settings_.ShowValue(row, value); }
  void ShowMeasures(const presenter::MeasuresPage& page) override;

  presenter::PanelPresenter presenter_{*this};
  Gtk::Box cards_{Gtk::Orientation::VERTICAL};
  TaskCard task_;
  HandsCard hands_;
  OperationCard operation_{presenter_};
  SettingsCards settings_{presenter_};
  MeasuresCard measures_;
  PatientCard patient_;
  StagesCard stages_;
};

}  // namespace trocar::app
