// SPDX-License-Identifier: Apache-2.0
/// \file panel_cards.h  The cards of the simulator's panel; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "force_bar.h"
#include "trocar/gui/card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/panel_presenter.h"

namespace trocar::app {

/// How the task goes; hidden in a scene without one.
class TaskCard : public gui::Card {
 public:
  TaskCard();
  void ShowScene(const presenter::ScenePage& page);
  void Show(const presenter::TaskReadOut& page);

 private:
  Gtk::Label name_, about_, next_, errors_;
  Gtk::Label *time_, *progress_, *score_;
};

/// Force on each instrument, and what it meets.
class HandsCard : public gui::Card {
 public:
  HandsCard();
  void Show(const presenter::HandPages& page);
  void ShowNames(const presenter::OperationPage& page);

 private:
  struct Row {
    Gtk::Label name, force, contact;
    ForceBar bar;
  };
  std::array<Row, instrument::kHandCount> rows_;
};

/// Tools, liquids and the assistant; hidden where there is one tool a hand, and nothing else to do.
class OperationCard : public gui::Card {
 public:
  explicit OperationCard(presenter::PanelPresenter& presenter);
  void ShowScene(const presenter::ScenePage& page);
  void Show(const presenter::OperationPage& page);

 private:
  void AddTray(presenter::PanelPresenter& presenter, instrument::Hand hand);

  std::array<Gtk::DropDown, instrument::kHandCount> trays_;
  Gtk::Label *clips_, *blood_, *bile_, *stones_, *assistant_does_;
  Gtk::DropDown assistant_;
  bool is_showing_ = false;  // lists are being set by us
};

/// Sliders, a card for each group of SettingRows().
class SettingsCards {
 public:
  explicit SettingsCards(presenter::PanelPresenter& presenter);
  const std::vector<std::unique_ptr<gui::Card>>& Cards() const { return cards_; }
  void Show(const presenter::SettingsPage& page);
  void ShowValue(std::size_t row, const std::string& value);

 private:
  struct Row {
    Gtk::Label value;
    Gtk::Scale slider;
  };
  void AddCard(presenter::PanelPresenter& presenter, const char* group);
  void AddSolver(presenter::PanelPresenter& presenter);
  void AddRow(presenter::PanelPresenter& presenter, std::size_t place);

  std::vector<std::unique_ptr<gui::Card>> cards_;
  std::vector<std::unique_ptr<Row>> rows_;
  Gtk::DropDown solver_;
  Gtk::Button defaults_{host::Translate("Defaults")};
  bool is_showing_ = false;  // sliders are being moved by us
};

/// Solver and times.
class MeasuresCard : public gui::Card {
 public:
  MeasuresCard();
  void Show(const presenter::MeasuresPage& page);

 private:
  Gtk::Label *residual_, *iterations_, *tick_, *late_, *pictures_, *time_;
};

/// Card of the patient whose organs are shown; hidden in a scene without a patient.
class PatientCard : public gui::Card {
 public:
  PatientCard();
  void Show(const presenter::ScenePage& page);

 private:
  Gtk::Label name_, organs_, source_;
};

/// How long each stage of a tick takes.
class StagesCard : public gui::Card {
 public:
  StagesCard();
  void Show(const presenter::MeasuresPage& page);

 private:
  std::array<Gtk::Label, simulation::kStageCount> stages_;
};

}  // namespace trocar::app
