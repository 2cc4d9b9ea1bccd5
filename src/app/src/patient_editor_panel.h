// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_panel.h  The right side of the patient editor: tools, their settings, findings.
#pragma once

#include <gtkmm.h>

#include <vector>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/app/patient_editor.h"

namespace trocar::app {

class PatientEditorPanel : public Gtk::Box {
 public:
  PatientEditorPanel();

  /// What the panel shows and changes from now on; it must outlive the panel.
  void SetEditor(PatientEditor* editor);
  /// Shows what is chosen and what there is.
  void Refresh();
  void ShowFindings(const anatomy::LintReport& report);

  /// The editor was changed by the panel.
  sigc::signal<void()>& SignalChanged() { return signal_changed_; }
  sigc::signal<void(core::Error)>& SignalRefused() { return signal_refused_; }
  /// A finding was clicked: its `where`.
  sigc::signal<void(Glib::ustring)>& SignalLookAt() { return signal_look_at_; }

 private:
  Gtk::Box& AddCard(const char* title);
  void MakeTools();
  void MakePaintCard();
  void MakeTubeCard();
  void MakeLandmarkCard();
  void MakeLookCard();
  void MakeFindingsCard();
  void Announce();
  void EmitChanged();
  void Report(const core::Status& status);
  void RefreshRegions();
  void RefreshTubes();
  void RefreshEnds();
  void RefreshLandmarks();
  void JoinChosen(anatomy::TubeEnd end, const Gtk::DropDown& names);

  PatientEditor* editor_ = nullptr;
  bool is_showing_ = false;    // widgets are being set by us
  bool is_announced_ = false;  // SignalChanged follows

  std::vector<Gtk::ToggleButton*> tools_;
  Gtk::Box *paint_card_ = nullptr, *tube_card_ = nullptr, *landmark_card_ = nullptr;
  Gtk::DropDown regions_, from_, to_, missing_;
  Gtk::ToggleButton add_{"Paint"}, erase_{"Erase"};
  Gtk::Scale brush_{Gtk::Orientation::HORIZONTAL}, reach_{Gtk::Orientation::HORIZONTAL},
      opacity_{Gtk::Orientation::HORIZONTAL};
  Gtk::ListBox tubes_, landmarks_, findings_;
  Gtk::Button insert_{"Insert point"}, delete_{"Delete point"}, remove_{"Remove"}, add_tube_{"Add"};
  Gtk::CheckButton edges_{"Triangles"}, strands_{"Bed strands"}, colours_{"Regions"};
  Gtk::Label tube_facts_, findings_title_;
  std::vector<RegionChoice> region_choices_;
  std::vector<std::string> end_names_, missing_names_, wheres_;
  sigc::signal<void()> signal_changed_;
  sigc::signal<void(core::Error)> signal_refused_;
  sigc::signal<void(Glib::ustring)> signal_look_at_;
};

}  // namespace trocar::app
