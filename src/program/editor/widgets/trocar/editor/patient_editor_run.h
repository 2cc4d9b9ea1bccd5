// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_run.h  Runs of the patient editor that are not attended: its picture, and a report.
#pragma once

#include <gtkmm.h>

#include "trocar/editor/mesh_view.h"
#include "trocar/editor/patient_editor_presenter.h"

namespace trocar::editor {

/// Waits for the patient, looks at what the tool works on, saves the picture, prints a report and closes the window.
class PatientEditorRun {
 public:
  /// Of the window; they outlive the run.
  struct Parts {
    Gtk::Window& window;
    PatientEditorPresenter& presenter;
    MeshView& view;
  };

  explicit PatientEditorRun(const Parts& parts);
  ~PatientEditorRun();

 private:
  bool OnTime();
  void Look();
  void SaveScreenshot();

  Parts at_;
  sigc::connection timer_;
};

}  // namespace trocar::editor
