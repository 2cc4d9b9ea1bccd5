// SPDX-License-Identifier: Apache-2.0
/// \file contour_cards.h  The cards of the contour window's panel; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <string>
#include <vector>

#include "trocar/editor/contour_panel_presenter.h"
#include "trocar/editor/mesh_view.h"
#include "trocar/gui/card.h"
#include "trocar/host/translate.h"

namespace trocar::editor {

/// The list of organs; a name is asked for in a popover.
class OrganCard : public gui::Card {
 public:
  /// \param presenter  outlives the card
  explicit OrganCard(ContourPanelPresenter& presenter);
  ~OrganCard() override;
  void Show(const std::vector<ContourPanelPage::Organ>& organs);

 private:
  void AskName(bool is_new);
  void TakeName();
  Gtk::Widget& MakeRow(const ContourPanelPage::Organ& organ, int structure);

  ContourPanelPresenter& presenter_;
  Gtk::Box organs_{Gtk::Orientation::VERTICAL};
  std::vector<ContourPanelPage::Organ> shown_;
  Gtk::Popover name_popover_;
  Gtk::Entry name_entry_;
  bool is_naming_new_ = false;
  Gtk::Button add_{host::Translate("Add")}, rename_{host::Translate("Rename")},
      delete_{host::Translate("Delete")};
};

/// The slice that is shown: what is in it, and commands for all of it.
class SliceCard : public gui::Card {
 public:
  SliceCard();
  void Show(const ContourPanelPage& page);
  sigc::signal<void(ContourAction)>& SignalAction() { return signal_action_; }

 private:
  Gtk::Label title_, text_, notes_;
  sigc::signal<void(ContourAction)> signal_action_;
};

/// Sliders of the edge search and of the step.
class EdgeCard : public gui::Card {
 public:
  /// \param presenter  outlives the card
  explicit EdgeCard(ContourPanelPresenter& presenter);
  void Show(const ContourPanelPage& page);

 private:
  struct Row {
    Gtk::Scale scale;
    Gtk::Label value;
  };
  void Add(Row& row, const char* name, const char* tip, double low, double high, double step,
           std::function<void(double)> act);

  Row reach_, skipped_, step_;
  bool is_showing_ = false;  // sliders are being set by us
};

/// The organs' surfaces, and how far the next ones are.
class SurfaceCard : public gui::Card {
 public:
  SurfaceCard();
  MeshView& View() { return view_; }
  void ShowText(const std::string& text);
  void ShowJob(const contours::MeshJob::State& state);
  sigc::signal<void()>& SignalCancel() { return signal_cancel_; }

 private:
  MeshView view_;
  Gtk::Label text_;
  Gtk::ProgressBar progress_;
  Gtk::Button cancel_{host::Translate("Cancel")};
  sigc::signal<void()> signal_cancel_;
};

}  // namespace trocar::editor
