// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_panel.h  The right side of the patient editor: tools, their settings, findings.
#pragma once

#include <gtkmm.h>

#include <vector>

#include "trocar/editor/patient_cards.h"
#include "trocar/editor/patient_panel_presenter.h"

namespace trocar::editor {

class PatientEditorPanel : public Gtk::Box, private PatientPanelScreen {
 public:
  PatientEditorPanel();

  /// Sets the editor that the panel shows and changes from now on; it outlives its use.
  void SetEditor(PatientEditor* editor) { presenter_.UseEditor(editor); }
  /// Shows what is chosen and what there is.
  void Refresh() { presenter_.Refresh(); }
  void ShowFindings(const anatomy::LintReport& report) { findings_.Show(MakeFindingsPage(report)); }

  /// The editor was changed by the panel.
  sigc::signal<void()>& SignalEdited() { return signal_edited_; }
  sigc::signal<void(base::Error)>& SignalRefused() { return signal_refused_; }
  /// A finding was clicked: its `where`.
  sigc::signal<void(std::string)>& SignalLookAt() { return findings_.SignalLookAt(); }

 private:
  void AddTools();
  void EmitEdited();

  // PatientPanelScreen
  void Show(const PatientPanelPage& page) override;
  void OnEdited() override;
  void OnRefused(const base::Error& error) override { signal_refused_.emit(error); }

  PatientPanelPresenter presenter_{*this};
  std::vector<Gtk::ToggleButton*> tools_;
  PaintCard paint_{presenter_};
  TubeCard tubes_{presenter_};
  LandmarkCard landmarks_{presenter_};
  LookCard look_{presenter_};
  FindingsCard findings_;
  bool is_showing_ = false;   // widgets are being set by us
  bool is_edit_due_ = false;  // SignalEdited follows
  sigc::signal<void()> signal_edited_;
  sigc::signal<void(base::Error)> signal_refused_;
};

}  // namespace trocar::editor
