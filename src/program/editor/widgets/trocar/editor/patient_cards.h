// SPDX-License-Identifier: Apache-2.0
/// \file patient_cards.h  The cards of the patient editor's panel; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <string>
#include <vector>

#include "trocar/editor/patient_panel_presenter.h"
#include "trocar/gui/card.h"
#include "trocar/host/translate.h"

namespace trocar::editor {

/// Widgets are being set by us while one of these lives, so their signals mean nothing.
class Showing {
 public:
  explicit Showing(bool& is_showing) : is_showing_(is_showing) { is_showing_ = true; }
  ~Showing() { is_showing_ = false; }
  Showing(const Showing&) = delete;
  Showing& operator=(const Showing&) = delete;

 private:
  bool& is_showing_;
};

/// A list of names of which one is chosen.
class ChoiceBox : public Gtk::DropDown {
 public:
  /// \param act  called with the place that a person has chosen
  explicit ChoiceBox(std::function<void(std::size_t)> act);
  void Show(const ChoicePage& page);

 private:
  std::vector<std::string> shown_;
  bool is_showing_ = false;
};

/// A slider with its value beside it.
class ValueSlider : public Gtk::Scale {
 public:
  ValueSlider(double low, double high, int digits, std::function<void(double)> act);
  void Show(double value);

 private:
  bool is_showing_ = false;
};

/// Which region the brush paints.
class PaintCard : public gui::Card {
 public:
  explicit PaintCard(PatientPanelPresenter& presenter);
  void Show(const PatientPanelPage& page);

 private:
  ChoiceBox regions_;
  Gtk::ToggleButton paint_{host::Translate("Paint")}, erase_{host::Translate("Erase")};
  ValueSlider brush_;
  bool is_showing_ = false;
};

/// Ducts and arteries: which, what they join, their points.
class TubeCard : public gui::Card {
 public:
  explicit TubeCard(PatientPanelPresenter& presenter);
  void Show(const PatientPanelPage& page);

 private:
  void AddEnds();
  void AddButtons(PatientPanelPresenter& presenter);
  Gtk::Widget& MakeRow(const PatientPanelPage::Tube& tube);

  Gtk::ListBox tubes_;
  std::vector<PatientPanelPage::Tube> shown_;
  Gtk::Label facts_;
  ChoiceBox from_, to_, missing_;
  ValueSlider reach_;
  Gtk::Button insert_{host::Translate("Insert point")}, delete_{host::Translate("Delete point")},
      remove_{host::Translate("Remove")}, add_{host::Translate("Add")};
  bool is_showing_ = false;
};

class LandmarkCard : public gui::Card {
 public:
  explicit LandmarkCard(PatientPanelPresenter& presenter);
  void Show(const PatientPanelPage& page);

 private:
  Gtk::ListBox landmarks_;
  std::vector<PatientPanelPage::Landmark> shown_;
  bool is_showing_ = false;
};

/// Card for the choice of the parts of the patient that are drawn.
class LookCard : public gui::Card {
 public:
  explicit LookCard(PatientPanelPresenter& presenter);
  void Show(const PatientPanelPage& page);

 private:
  Gtk::CheckButton colours_{host::Translate("Regions")}, edges_{host::Translate("Triangles")},
      strands_{host::Translate("Bed strands")};
  Gtk::Scale opacity_{Gtk::Orientation::HORIZONTAL};
  view::PatientFigureOptions look_;
  bool is_showing_ = false;
};

/// Card with the findings of the check.
class FindingsCard : public gui::Card {
 public:
  FindingsCard();
  void Show(const FindingsPage& page);
  /// A finding was clicked: its `where`.
  sigc::signal<void(std::string)>& SignalLookAt() { return signal_look_at_; }

 private:
  Gtk::Label title_;
  Gtk::ListBox findings_;
  std::vector<std::string> wheres_;
  sigc::signal<void(std::string)> signal_look_at_;
};

}  // namespace trocar::editor
