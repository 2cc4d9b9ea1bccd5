// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_cards.h  The right side of the way from images to an operation: what there is to choose at each step.
#pragma once

#include <gtkmm.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "trocar/gui/card.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/host/translate.h"
#include "trocar/rehearsal/rehearsal_presenter.h"

namespace trocar::rehearsal {

/// A path that is typed, or chosen in the system's dialog.
class PathRow : public Gtk::Box {
 public:
  /// \param title  of the dialogs, and what a screen reader says of the field
  PathRow(std::string title, std::vector<gui::FileRequest::Kind> kinds, bool has_folder);

  void Show(const std::string& path);
  void Focus() { path_.grab_focus(); }
  sigc::signal<void(std::filesystem::path)>& SignalChosen() { return signal_chosen_; }

 private:
  void Ask(bool is_folder);

  std::string title_, shown_;
  std::vector<gui::FileRequest::Kind> kinds_;
  Gtk::Entry path_;
  gui::FileDialog dialog_;
  sigc::signal<void(std::filesystem::path)> signal_chosen_;
};

class ImagesCard : public gui::Card {
 public:
  explicit ImagesCard(RehearsalPresenter& presenter);
  void Show(const RehearsalPage& page);
  void Focus() { path_.Focus(); }

 private:
  Gtk::Widget& MakeRow(const RehearsalSeries& series, std::size_t index, bool is_chosen);

  RehearsalPresenter& presenter_;
  PathRow path_;
  Gtk::Box series_{Gtk::Orientation::VERTICAL};
  Gtk::ScrolledWindow scroller_;
  std::vector<std::string> shown_;
};

class OrgansCard : public gui::Card {
 public:
  explicit OrgansCard(RehearsalPresenter& presenter);
  void Show(const RehearsalPage& page);

 private:
  void Choose();

  RehearsalPresenter& presenter_;
  PathRow labels_;
  Gtk::Box choices_{Gtk::Orientation::VERTICAL};
  std::array<Gtk::DropDown, 2> organs_;  // liver, gallbladder
  std::vector<int> shown_;               // labels, as the lists have them
  Gtk::Button draw_{host::Translate("Draw the outlines")};
  bool is_showing_ = false;
};

/// Lines to read, in a column that scrolls.
class LinesCard : public gui::Card {
 public:
  explicit LinesCard(const char* title);
  void Show(const std::vector<RehearsalLine>& lines);

 private:
  Gtk::Box lines_{Gtk::Orientation::VERTICAL};
  std::vector<RehearsalLine> shown_;
};

class PortsCard : public gui::Card {
 public:
  explicit PortsCard(RehearsalPresenter& presenter);
  void Show(const RehearsalPage& page);
  /// Gives the keyboard to the chosen port.
  void Focus();

 private:
  void AddSpin(Gtk::Box& row, const char* name, Gtk::SpinButton& spin);
  void MakePort(std::size_t index);

  struct Row {
    Gtk::ToggleButton* button;
    Gtk::Label *name, *place, *reason;
  };
  RehearsalPresenter& presenter_;
  Gtk::Box ports_{Gtk::Orientation::VERTICAL};
  std::vector<Row> rows_;
  Gtk::SpinButton head_up_, right_up_;
  Gtk::Label table_reason_;
  Gtk::Button undo_{host::Translate("Undo")}, redo_{host::Translate("Redo")},
      reset_{host::Translate("As proposed")};
  std::array<Gtk::Button, 4> moves_;
  std::size_t chosen_ = 0;
  bool is_showing_ = false;
};

}  // namespace trocar::rehearsal
